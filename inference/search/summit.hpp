// Search for a much narrower posterior mode near the maximum of a known posterior mode.
#pragma once

#include <optional>

#include "base/eigen.hpp"
#include "inference/search/climb.hpp"

namespace wheeltap::inference {

/// Finds a point near a posterior mode where ln π exceeds its value at the mode by more than
/// `kAboveSummit`. A local search ends about a tenth of a standard deviation from the maximum, so
/// the search may miss a narrower spike near the maximum. Newton's method starts from the posterior
/// mode and uses differences over 3e-5 standard deviations. This method finds the maxima of the two
/// functions
///
///   ln π(z),   and   ln π(z) + |z|²/2  (the likelihood, if it has a maximum),
///
/// to about 1e-9 standard deviations. At these two points, the function misses only spikes narrower
/// than 1e-9 standard deviations. The function does not search at other points. Uses at most
/// `summit_calls(d)` likelihood evaluations.
[[nodiscard]] std::optional<Eigen::VectorXd> above_summit(Surface& f, const KnownMode& mode);

inline constexpr double kAboveSummit = 2.0;  ///< nats
inline constexpr int kSummitSteps = 6;       ///< steps of Newton's method for each maximum
[[nodiscard]] constexpr long summit_calls(long dimension) {
  return 2 * kSummitSteps * (2 * dimension + 1);
}

}  // namespace wheeltap::inference
