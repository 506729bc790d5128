// What defects do to a discretised structure: terms of low rank in K and M, and scales of parts.
#pragma once

#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// What defects change: terms of low rank, and scales of whole parts of K.
struct StructureChange {
  /// Strains e = Bu of a few rows become stiffer or softer along one direction v, |v| = 1, of them:
  /// Bᵀ B turns into Bᵀ (I - (1 - q) v vᵀ) B, q > 0. Directions that share rows must be orthogonal.
  struct Softening {
    std::vector<std::pair<int, double>> direction;  ///< rows of `Discretisation::strains`, v
    double remaining = 1.0;                         ///< q in (0, 1]
  };
  /// K gains k r rᵀ, r · u a motion; ∞ holds it.
  struct Spring {
    SparseRow motion;
    double stiffness;  ///< k [N/m], [N·m/rad]
  };
  /// M gains μ r rᵀ, r · u a motion. What is taken away must leave M positive (semi)definite.
  struct Mass {
    SparseRow motion;
    double mass;  ///< μ [kg], [kg·m²]; negative where mass is lost
  };

  /// A part of K_rest (`Discretisation::parts`) keeps q of itself, q > 0: a change of any rank,
  /// which no reanalysis by columns takes.
  struct Scaling {
    int part;
    double remaining = 1.0;  ///< q in (0, 1]
  };

  std::vector<Softening> softenings = {};
  std::vector<Spring> springs = {};
  std::vector<Mass> masses = {};
  std::vector<Scaling> scalings = {};

  [[nodiscard]] bool empty() const {
    return softenings.empty() && springs.empty() && masses.empty() && scalings.empty();
  }
};

/// A change that leaves no structure: more mass taken than there is, or so much stiffness that
/// compressed members buckle.
class ImpossibleChange : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Softenings of one and the same strain become one, whose remaining stiffness is their product; so
/// do scalings of one part.
void compound(StructureChange& change);

/// The discretisation with these changes made: the reference for the reanalysis. What rigid springs
/// hold is eliminated, from `motions` of d, too, which become those of what is left. Throws
/// std::invalid_argument as `StructureReanalysis::solve`, ImpossibleChange for more mass taken than
/// there is.
[[nodiscard]] Discretisation changed(const Discretisation& d, const StructureChange& change,
                                     std::span<SparseRow> motions = {});

/// Throws ImpossibleChange where masses take away more than M has: where M with them, L D Lᵀ, has a
/// negative D. Costs nothing where none is taken.
void require_mass_left(const Discretisation& d, const StructureChange& change);

/// Throws std::invalid_argument for q outside (0, 1], k <= 0, masses that are not finite, and
/// strains or parts that there are not.
void validate(const Discretisation& d, const StructureChange& change);

}  // namespace wheeltap::fem
