// What the windows of a record, each by itself, say of one parameter.
#pragma once

#include <optional>
#include <vector>

#include "inference/statistics/hierarchical_posterior.hpp"

namespace wheeltap::identification {

/// A distribution in short: its quantiles of 2.5, 5, 50, 95 and 97.5 %.
struct Interval {
  double mean = 0.0, sd = 0.0;
  double q2_5 = 0.0, q5 = 0.0, q50 = 0.0, q95 = 0.0, q97_5 = 0.0;
};

struct BetweenWindows {
  /// What a further window of this length would give, found as the others were: the interval for a
  /// record that was not used.
  Interval next;
  /// What ever longer records would give, fitted as a whole: the best value of this one, with the
  /// error that the windows' scores put on it (mean and sd are these two). None where the whole
  /// has no normal about its mode.
  std::optional<Interval> whole = {};
  /// The windows' scatter in terms of what their own intervals allow for, and how likely these
  /// alone would do so.
  inference::BirgeRatio scatter;
  /// They scatter by half as much again or more, and not by chance: the run's own interval, from
  /// residuals as its likelihood takes them, does not hold from one to the next.
  [[nodiscard]] bool scatters() const { return scatter.ratio >= 1.5 && scatter.p_value < 1e-3; }
  /// Of each window: its own value and standard deviation; NaN where it has none.
  std::vector<double> value, sd;
};

}  // namespace wheeltap::identification
