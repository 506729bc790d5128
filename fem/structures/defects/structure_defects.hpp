// Defects of a structure made of members, and the changes of its matrices that they cause.
#pragma once

#include <vector>

#include "fem/structures/defects/crack.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {

struct StructureDefects {
  /// A stiffness reduction of one element. The element that contains `at` keeps the fraction 1 - r
  /// of its axial, torsional, bending and shear stiffness.
  struct ElementReduction {
    int member;
    double at;         ///< [m] from the member's first end
    double reduction;  ///< r in [0, 1)
  };
  /// A stiffness reduction of the segment of a member from `from` to `to`. All stiffnesses of this
  /// segment are multiplied by 1 - r. Where two reductions overlap, the fraction (1
  /// - r₁)(1 - r₂) remains.
  struct Reduction {
    int member;
    double from, to;   ///< [m] from the member's first end
    double reduction;  ///< r in [0, 1)
  };
  /// An open crack across the z axis of the section, with the depth ratio a/h.
  struct Crack {
    int member;
    double at;     ///< [m] from the member's first end
    double depth;  ///< a/h in [0, 1)
    const CrackLaw* law;
  };
  /// A reduction of the rotational stiffness of a joint or support. If the joint has springs
  /// (member ends with a finite stiffness, rotational springs to ground), each spring keeps the
  /// fraction 1 - r of its stiffness. Without springs, every rigidly joined member end gets the
  /// fixity 1 - r (Monforton & Wu 1963). The member end then rotates relative to the joint by r /
  /// (1 - r) · L / (3 E I) per unit of moment.
  struct LooseJoint {
    int node;
    double reduction;  ///< r in [0, 1)
  };
  /// A point mass attached to a member, without rotary inertia.
  struct AddedMass {
    int member;
    double at;    ///< [m]
    double mass;  ///< added mass [kg]; negative for removed mass
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

/// Computes the changes of the matrices that the defects cause. Reductions, cracks and loose joints
/// add flexibility to an element: for the stresses t, the strains are (I + ΔF) t. The bending
/// moment M(ξ) = v(ξ) · t follows from the constant moment and the constant shear force of the
/// element,
///
///   v = (√(EI/l), √(12 EI / (l (1 + Φ))) (ξ - ½)).
///
/// A crack of compliance c at ξ adds c v vᵀ. A segment of reduced stiffness adds r/(1 - r) ∫ v vᵀ
/// dx / EI and the corresponding shear flexibility. The eigenvectors of I + ΔF are the directions
/// of StructureChange::Softening; the reciprocals of its eigenvalues are the remaining fractions.
///
/// The rotation θ = c v · t of a hinge also displaces the mass of the element by g(x) θ. The
/// function g is (x - x₀)₊ minus the interpolation of (x - x₀)₊ by the shape functions. With θ = p
/// · Bu, the mass matrix becomes M + m pᵀB + Bᵀp mᵀ + g² Bᵀp pᵀB, m = ∫ ρA N g + ρI N_θ g'. The
/// change of M is equivalent to one added and one removed mass.
///
/// The defects are added to the initial change `change`. If several softenings act on the same
/// strain, their remaining fractions are multiplied. Throws std::invalid_argument for locations
/// outside a member and values out of range.
[[nodiscard]] StructureChange change_of(const Mesh& mesh, const StructureDefects& defects,
                                        StructureChange change = {});

}  // namespace wheeltap::fem
