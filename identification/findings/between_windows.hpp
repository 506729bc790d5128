// One parameter, estimated from each window of a record separately.
#pragma once

#include <optional>
#include <vector>

#include "inference/statistics/hierarchical_posterior.hpp"

namespace wheeltap::identification {

/// Mean, standard deviation and the 2.5, 5, 50, 95 and 97.5 % quantiles of a distribution.
struct Interval {
  double mean = 0.0, sd = 0.0;
  double q2_5 = 0.0, q5 = 0.0, q50 = 0.0, q95 = 0.0, q97_5 = 0.0;
};

struct BetweenWindows {
  /// Prediction for one further window of this length: the interval for a record not used.
  Interval next;
  /// Limit for ever longer records, fitted as a whole: mean is the best value of this record, sd
  /// its error from the windows' scores. Empty if the whole record's posterior has no normal
  /// approximation.
  std::optional<Interval> whole = {};
  /// Birge ratio of the windows' scatter to their own intervals, and its p-value.
  inference::BirgeRatio scatter;
  /// True if the ratio is at least 1.5 and not by chance. If so, the run's own interval, which
  /// assumes the residuals of the likelihood, does not hold from one window to the next.
  [[nodiscard]] bool scatters() const { return scatter.ratio >= 1.5 && scatter.p_value < 1e-3; }
  /// Value and standard deviation per window; NaN for a failed window.
  std::vector<double> value, sd;
};

}  // namespace wheeltap::identification
