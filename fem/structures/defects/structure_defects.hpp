// Defects of a structure of members, and the changes of its matrices by each.
#pragma once

#include <vector>

#include "fem/structures/defects/crack.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {

struct StructureDefects {
  /// A stiffness reduction of one element: the element that contains `at` keeps the share 1 - r of
  /// its stiffness in every strain.
  struct ElementReduction {
    int member;
    double at;         ///< [m] from the member's first end
    double reduction;  ///< r in [0, 1)
  };
  /// A stiffness reduction of a segment: from `from` to `to`, within the ends of the member, the
  /// member keeps the share 1 - r of its stiffness in every strain. Overlapping reductions
  /// multiply, (1 - r₁)(1 - r₂).
  struct Reduction {
    int member;
    double from, to;   ///< [m] from the member's first end
    double reduction;  ///< r in [0, 1)
  };
  /// An open crack across the section's z axis, of depth ratio a/h.
  struct Crack {
    int member;
    double at;     ///< [m] from the member's first end
    double depth;  ///< a/h in [0, 1)
    const CrackLaw* law;
  };
  /// A loose joint or rotational support. If the joint has springs (member ends with a finite
  /// stiffness, rotational springs to ground), each spring keeps the share 1 - r of its stiffness.
  /// Otherwise every rigidly joined end gets the fixity 1 - r, that is a rotation of r / (1 - r) ·
  /// L / (3 E I) per unit of moment (Monforton & Wu 1963).
  struct LooseJoint {
    int node;
    double reduction;  ///< r in [0, 1)
  };
  /// A mass that moves with the member in all directions, without rotary inertia.
  struct AddedMass {
    int member;
    double at;    ///< [m]
    double mass;  ///< [kg]; negative for removed mass
  };
  /// A spring to ground.
  struct AddedSupport {
    int member;
    double at;  ///< [m]
    Direction direction;
    double stiffness;  ///< [N/m], [N·m/rad]; ∞ is rigid
  };

  std::vector<ElementReduction> elements = {};
  std::vector<Reduction> reductions = {};
  std::vector<Crack> cracks = {};
  std::vector<LooseJoint> joints = {};
  std::vector<AddedMass> masses = {};
  std::vector<AddedSupport> supports = {};
};

/// Reductions, cracks and loose ends add flexibility to the strains of an element: for stresses t,
/// the strains are (I + ΔF) t. A bending moment is M(ξ) = v(ξ) · t on the element's constant moment
/// and constant shear force,
///
///   v = (√(EI/l), √(12 EI / (l (1 + Φ))) (ξ - ½)).
///
/// A crack of compliance c at ξ adds c v vᵀ. A segment of reduced stiffness adds r/(1 - r) ∫ v vᵀ
/// dx / EI, with its share of shear. The eigenvectors of I + ΔF are the directions of
/// StructureChange::Softening; the inverses of its eigenvalues are the remaining stiffnesses.
///
/// The rotation θ = c v · t of a hinge also moves the mass of the element, by g(x) θ, where g is (x
/// - x₀)₊ minus its interpolation by the shape functions. With θ = p · Bu this gives M + m pᵀB +
/// Bᵀp mᵀ + g² Bᵀp pᵀB, m = ∫ ρA N g + ρI N_θ g': a positive and a negative mass.
///
/// Throws std::invalid_argument for places outside a member and values out of range. `change` is
/// the initial change; softenings of the same strain multiply.
[[nodiscard]] StructureChange change_of(const Mesh& mesh, const StructureDefects& defects,
                                        StructureChange change = {});

}  // namespace wheeltap::fem
