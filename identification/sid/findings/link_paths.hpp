// What each link of a chain went through: extension, its rate and tension, sample by sample, of the
// model and, where the record tells it, of the data.
#pragma once

#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// All links between masses a and b together, over the scored samples: with the extension
/// e = z_b - z_a, their tension T pulls a towards b (dynamics/chain.hpp).
struct LinkPath {
  int a = 0, b = 0;
  std::vector<double> extension;  ///< e [m] of the model's motion
  std::vector<double> rate;       ///< ė [m/s] of the model's motion
  std::vector<double> tension;    ///< T [N] of the model's motion
  /// T [N] by the balance of forces with measured accelerations; NaN where it is not known, empty
  /// where it is known nowhere.
  std::vector<double> measured;
  /// The measured extension [m], where both ends were measured; empty otherwise.
  std::vector<double> measured_extension;
  bool differentiated = false;  ///< an acceleration behind `measured` is a numerical derivative
};

/// Of a model with parameters `theta` of the case. The tensions follow from the balance of forces
///
///   Σ ±T = m_j ÿ_j - F_j  of each mass j, ÿ the absolute acceleration,
///
/// so that laws with a memory need no state: where links close a loop the balance does not
/// determine them, and there are no paths; nor are there where the response fails. `measured` takes
/// the masses and scales from `theta` and ÿ from the record: measured, or the derivative of order
/// eight of a measured velocity or displacement (Fornberg 1988). Withheld where the noise of the
/// record, estimated by its sixth differences, would be more than a tenth of the tension's range.
[[nodiscard]] std::vector<LinkPath> link_paths(const SidProblem& problem, int model,
                                               std::span<const double> theta);

}  // namespace wheeltap::identification
