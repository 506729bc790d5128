// Changes that defects cause in a discretised structure: low-rank terms in K and M, and scale
// factors of parts of K.
#pragma once

#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// Changes of K and M that defects cause: low-rank terms, and scale factors of whole parts of
/// K.
struct StructureChange {
  /// A stiffness reduction for the combination v · e of a few strains e = Bu, |v| = 1: Bᵀ B becomes
  /// Bᵀ (I - (1 - q) v vᵀ) B, q > 0. Directions v that share strains must be orthogonal.
  struct Softening {
    std::vector<std::pair<int, double>> direction;  ///< rows of `Discretisation::strains`, v
    double remaining = 1.0;                         ///< q in (0, 1]
  };
  /// A spring adds k r rᵀ to K, where r · u is the displacement or rotation that the spring
  /// restrains. A spring with k = ∞ is a rigid support.
  struct Spring {
    SparseRow motion;
    double stiffness;  ///< k [N/m], [N·m/rad]
  };
  /// A mass adds μ r rᵀ to M, where r · u is the displacement or rotation of the mass. The changed
  /// M must be positive (semi)definite.
  struct Mass {
    SparseRow motion;
    double mass;  ///< μ [kg], [kg·m²]; negative for removed mass
  };

  /// A scale factor q > 0 of a part of K_rest (`Discretisation::parts`). A scaling can have any
  /// rank, so column-based reanalysis does not support scalings.
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

/// Thrown for a change after which the structure is invalid: the change removes more mass than the
/// structure has, or so much stiffness that compressed members buckle.
class ImpossibleChange : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Combines several softenings of the same strain into one softening, and several scalings of the
/// same part into one scaling. The combined fraction q is the product of the fractions.
void compound(StructureChange& change);

/// Applies the changes to the discretisation. The modes of the result are the reference for the
/// reanalysis. The function eliminates the degrees of freedom that rigid springs restrain, and
/// expresses `motions` in the remaining degrees of freedom. Throws the exceptions of
/// `StructureReanalysis::solve`: std::invalid_argument, and ImpossibleChange if the change removes
/// more mass than the structure has.
[[nodiscard]] Discretisation changed(const Discretisation& d, const StructureChange& change,
                                     std::span<SparseRow> motions = {});

/// Throws ImpossibleChange if the changed M is indefinite, that is if D of M = L D Lᵀ has a
/// negative entry. Does nothing if the change removes no mass.
void require_mass_left(const Discretisation& d, const StructureChange& change);

/// Checks a change. Throws std::invalid_argument for q outside (0, 1], k <= 0, masses that are not
/// finite, and strains or parts that do not exist.
void validate(const Discretisation& d, const StructureChange& change);

}  // namespace wheeltap::fem
