// Posteriors that pile up at a bound of their prior: the bound, not the data, ends them.
//
// A posterior N(m, s²) that a bound cuts off at m - c s has, of the distances of its draws to that
// bound, a 2.5 % quantile over the 97.5 % quantile of 0.014 for c = 0, 0.028 for c = 1 and 0.083
// for c = 2; one that keeps away from the bound has more. So a narrow posterior near a bound of a
// wide prior does not pile up there.
#pragma once

#include <span>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

enum class PriorBound { none, lower, upper };

/// At which finite bound draws pile up: a quarter of their weight is in the prior's outer
/// twentieth, and of their distances to the bound the 2.5 % quantile is less than 0.05 of the 97.5
/// % quantile. A lower bound of 0 is a quantity's own, not the prior's. `weights`, one a draw, may
/// be empty: all alike.
[[nodiscard]] PriorBound bound_of(const inference::Prior& prior, std::span<const double> draws,
                                  std::span<const double> weights = {});

}  // namespace wheeltap::identification
