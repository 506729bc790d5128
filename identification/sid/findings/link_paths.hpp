// Extension, rate and tension of each link, sample by sample, from the model and, if possible, from
// measured data.
#pragma once

#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// Path (extension, rate and tension) of all links between masses a and b together, at the scored
/// samples. The common extension of these links is e = z_b - z_a. A positive tension T pulls mass a
/// towards mass b (dynamics/chain.hpp).
struct LinkPath {
  int a = 0, b = 0;
  std::vector<double> extension;  ///< extension e [m] in the simulated motion
  std::vector<double> rate;       ///< rate ė [m/s] in the simulated motion
  std::vector<double> tension;    ///< tension T [N] in the simulated motion
  /// T [N] from the balance of forces with measured accelerations. Unknown samples are NaN; the
  /// list is empty if all samples are unknown.
  std::vector<double> measured;
  /// Measured extension [m] if the motions of both ends were measured; otherwise empty.
  std::vector<double> measured_extension;
  /// True if `measured` uses a numerically differentiated acceleration
  bool differentiated = false;
};

/// Computes the path of each link for a model; `theta` are the parameters of the case. The tensions
/// follow from the balance of forces,
///
///   Σ ±T = m_j ÿ_j - F_j  for each mass j, ÿ the absolute acceleration.
///
/// This balance does not need the internal state of force laws with memory. The balance of forces
/// does not determine the tensions of links in a closed loop. The result is empty if there is such
/// a loop, or if the simulation fails.
///
/// `measured` uses masses and scales from `theta`, and ÿ from the record. If ÿ was not measured, ÿ
/// is computed from a measured velocity or displacement by finite differences of order eight
/// (Fornberg 1988). `measured` is omitted if the noise of the tension would exceed a tenth of the
/// range of the tension. The noise is estimated from sixth-order differences.
[[nodiscard]] std::vector<LinkPath> link_paths(const SidProblem& problem, int model,
                                               std::span<const double> theta);

}  // namespace wheeltap::identification
