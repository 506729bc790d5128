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
  /// Prediction of the parameter in one further window of the same length, that is in a record that
  /// was not used.
  Interval next;
  /// Estimate of the limit that a fit of the whole record approaches as the record becomes longer.
  /// The mean is the best value of this record, and sd its error from the scores of the windows.
  /// Empty if the posterior of the whole record has no normal approximation.
  std::optional<Interval> whole = {};
  /// Birge ratio of the windows' scatter to their own intervals, and its p-value.
  inference::BirgeRatio scatter;
  /// True if the ratio is at least 1.5 and significant. Then the interval of the run, which assumes
  /// that the residuals follow the likelihood, is too narrow for the scatter between windows.
  [[nodiscard]] bool scatters() const { return scatter.ratio >= 1.5 && scatter.p_value < 1e-3; }
  /// Value and standard deviation per window; NaN for a failed window.
  std::vector<double> value, sd;
};

}  // namespace wheeltap::identification
