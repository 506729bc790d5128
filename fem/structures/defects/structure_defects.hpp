// What may be wrong with a structure of members, and what each does to its matrices.
#pragma once

#include <vector>

#include "fem/structures/defects/crack.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {

struct StructureDefects {
  /// The element that contains `at` keeps 1 - r of its stiffness in every strain.
  struct ElementReduction {
    int member;
    double at;         ///< [m] from the member's first end
    double reduction;  ///< r in [0, 1)
  };
  /// From `from` to `to`, as far as that lies on the member, it keeps 1 - r of its stiffness in
  /// every strain. Where two overlap they compound, (1 - r₁)(1 - r₂).
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
  /// A joint or a rotational support that has come loose. Where there are springs (ends of members
  /// with a finite stiffness, rotational springs to ground), each keeps 1 - r of its stiffness;
  /// where there are none, every end that is joined rigidly keeps a fixity of 1 - r: it turns by
  /// r / (1 - r) · L / (3 E I) per moment (Monforton & Wu 1963).
  struct LooseJoint {
    int node;
    double reduction;  ///< r in [0, 1)
  };
  /// Moves with the member in all directions, without rotary inertia.
  struct AddedMass {
    int member;
    double at;    ///< [m]
    double mass;  ///< [kg]; negative where mass is lost
  };
  /// A spring to ground.
  struct AddedSupport {
    int member;
    double at;  ///< [m]
    Direction direction;
    double stiffness;  ///< [N/m], [N·m/rad]; ∞ holds
  };

  std::vector<ElementReduction> elements = {};
  std::vector<Reduction> reductions = {};
  std::vector<Crack> cracks = {};
  std::vector<LooseJoint> joints = {};
  std::vector<AddedMass> masses = {};
  std::vector<AddedSupport> supports = {};
};

/// What reductions, cracks and loose ends add to the flexibility of an element's strains: with
/// stresses t, the strains are (I + ΔF) t. A bending moment is M(ξ) = v(ξ) · t on the element's
/// constant moment and constant shear force,
///
///   v = (√(EI/l), √(12 EI / (l (1 + Φ))) (ξ - ½)),
///
/// so a crack of compliance c at ξ adds c v vᵀ, and a stretch of lost stiffness
/// r/(1 - r) ∫ v vᵀ dx / EI, with its share of shear. Eigenvectors of I + ΔF are the directions of
/// StructureChange::Softening, and the inverses of its eigenvalues what remains.
///
/// The kink θ = c v · t of a hinge also moves the element's mass: by g(x) θ, g = (x - x₀)₊ less its
/// interpolation by the element, which follows statically. With θ = p · Bu that is
/// M + m pᵀB + Bᵀp mᵀ + g² Bᵀp pᵀB, m = ∫ ρA N g + ρI N_θ g', a positive and a negative mass.
///
/// Throws std::invalid_argument for places outside a member and values out of range.
/// `change` begins as what else there is; softenings of one and the same strain compound.
[[nodiscard]] StructureChange change_of(const Mesh& mesh, const StructureDefects& defects,
                                        StructureChange change = {});

}  // namespace wheeltap::fem
