// Extension, rate and tension of each link, sample by sample, from the model and, if possible, from
// measured data.
#pragma once

#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// All links between masses a and b together, over the scored samples. With the extension
/// e = z_b - z_a, their tension T pulls a towards b (dynamics/chain.hpp).
struct LinkPath {
  int a = 0, b = 0;
  std::vector<double> extension;  ///< e [m] of the model's motion
  std::vector<double> rate;       ///< ė [m/s] of the model's motion
  std::vector<double> tension;    ///< T [N] of the model's motion
  /// T [N] from the balance of forces with measured accelerations. NaN where unknown, empty if
  /// unknown everywhere.
  std::vector<double> measured;
  /// Measured extension [m] if both ends were measured; otherwise empty.
  std::vector<double> measured_extension;
  bool differentiated = false;  ///< an acceleration in `measured` is a numerical derivative
};

/// Computes the paths for a model with parameters `theta` of the case. The tensions follow from the
/// balance of forces,
///
///   Σ ±T = m_j ÿ_j - F_j  for each mass j, ÿ the absolute acceleration,
///
/// without the internal state of laws with memory. This balance does not determine the tensions of
/// links in a closed loop; then, or if the simulation fails, the result is empty.
///
/// `measured` uses masses and scales from `theta`, and ÿ from the record: either measured or
/// computed from a measured velocity or displacement by finite differences of order eight (Fornberg
/// 1988). It is omitted if the noise, estimated from sixth differences, would exceed a tenth of the
/// tension's range.
[[nodiscard]] std::vector<LinkPath> link_paths(const SidProblem& problem, int model,
                                               std::span<const double> theta);

}  // namespace wheeltap::identification
