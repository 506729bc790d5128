// The very top of a mode, where a much narrower one may stand.
#pragma once

#include <optional>

#include "base/eigen.hpp"
#include "inference/search/climb.hpp"

namespace wheeltap::inference {

/// A point above a mode that is no part of it: where ln π exceeds the mode's top by more than
/// `kAboveSummit`. A climb ends a tenth of a standard deviation from the top, and misses a spike
/// there that is narrower than that. From the mode on, Newton's method with differences over 3e-5
/// standard deviations finds the maximum of
///
///   ln π(z),   and   ln π(z) + |z|²/2  (the likelihood's, if it has one near the mode),
///
/// to about 1e-9 standard deviations, which a spike at either place must be narrower than to be
/// missed. A spike elsewhere is not looked for. At most `summit_calls(d)` likelihood calls.
[[nodiscard]] std::optional<Eigen::VectorXd> above_summit(Surface& f, const KnownMode& mode);

inline constexpr double kAboveSummit = 2.0;  ///< nats
inline constexpr int kSummitSteps = 6;       ///< of Newton's method, for each of the two maxima
[[nodiscard]] constexpr long summit_calls(long dimension) {
  return 2 * kSummitSteps * (2 * dimension + 1);
}

}  // namespace wheeltap::inference
