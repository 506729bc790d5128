// Posteriors that pile up at a bound of their prior.
//
// Test statistic: the 2.5 % quantile of the draws' distances to the bound, divided by the 97.5 %
// quantile. For a posterior N(m, s²) that the bound cuts off at m - c s, it is 0.014 for c = 0,
// 0.028 for c = 1 and 0.083 for c = 2; for a posterior away from the bound it is larger. So a
// narrow posterior near a bound of a wide prior does not count.
#pragma once

#include <span>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

enum class PriorBound { none, lower, upper };

/// Returns the finite bound at which draws pile up: a quarter of their weight is in the prior's
/// outer 5 %, and the 2.5 % quantile of their distances to the bound is less than 0.05 times the
/// 97.5 % quantile. A lower bound of 0 is physical and does not count. `weights`: one per draw;
/// empty: all equal.
[[nodiscard]] PriorBound bound_of(const inference::Prior& prior, std::span<const double> draws,
                                  std::span<const double> weights = {});

}  // namespace wheeltap::identification
