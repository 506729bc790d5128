// Posteriors that pile up at a bound of their prior.
//
// Test statistic: the 2.5 % quantile of the draws' distances to the bound, divided by the 97.5 %
// quantile. For a posterior N(m, s²) truncated by a bound at m - c s, the statistic is 0.014 for c
// = 0, 0.028 for c = 1 and 0.083 for c = 2. The statistic increases with the distance from the
// bound. A narrow posterior near a bound of a wide prior therefore does not count as piling up
// at this bound.
#pragma once

#include <span>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

enum class PriorBound { none, lower, upper };

/// Returns the finite bound near which the draws concentrate. Two conditions must hold. More than a
/// quarter of the weight of the draws is in the outer 5 % of the prior. The 2.5 % quantile of the
/// distances between draws and bound is less than 0.05 times their 97.5 % quantile. A lower bound
/// of 0 is physical and is not reported. `weights` has one weight per draw; if it is empty, all
/// weights are equal.
[[nodiscard]] PriorBound bound_of(const inference::Prior& prior, std::span<const double> draws,
                                  std::span<const double> weights = {});

}  // namespace wheeltap::identification
