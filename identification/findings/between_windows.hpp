// Separate estimates of one parameter from each window of a record.
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
  /// Predictive distribution of the estimate from a new window of equal length, outside the fitted
  /// windows.
  Interval next;
  /// Estimate of the limit to which the fitted parameter value converges as the record becomes
  /// longer. The mean is the best estimate from this record; the sd is its standard error,
  /// computed from the score functions of the windows. `whole` is empty if the posterior of the
  /// whole record has no normal approximation.
  std::optional<Interval> whole = {};
  /// Birge ratio: the standard deviation of the estimates between windows, divided by the posterior
  /// standard deviations within windows; with its p-value.
  inference::BirgeRatio scatter;
  /// True if the Birge ratio is at least 1.5 and significant. The credible interval of the whole
  /// record assumes that the residuals follow the likelihood. If scatters() is true, this interval
  /// is too narrow for the variability between windows.
  [[nodiscard]] bool scatters() const { return scatter.ratio >= 1.5 && scatter.p_value < 1e-3; }
  /// Estimate and standard deviation of the parameter in each window; NaN for a window whose fit
  /// failed.
  std::vector<double> value, sd;
};

}  // namespace wheeltap::identification
