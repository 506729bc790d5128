// Control charts from the literature, for comparison with Wheeltap's detector:
//
//   Hotelling's T² of the features and of their residuals about a regression on the covariates,
//   the squared prediction error of principal components (Yan et al. 2005),
//   the residual of cointegration (Cross, Worden & Chen 2011),
//   T² of the residuals of Gaussian process regression on the covariates,
//   CUSUM (Page 1954) and multivariate EWMA (Lowry et al. 1992) of the residuals of the regression.
//
// Each chart is trained on the training rows of the baseline. The threshold of a chart is
// calibrated for the rate of false alarms that the case states. The calibration trains the chart on
// two thirds of the training rows and evaluates it on the remaining third, for each third in turn.
// The maxima of the statistic over blocks of these rows give the threshold.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

/// A trained control chart.
class ComparisonChart {
 public:
  virtual ~ComparisonChart() = default;
  /// The statistic of the next row, at least 0; NaN if missing features prevent its computation.
  virtual double add(const Row& row) = 0;
};

struct ChartKind {
  std::string name;
  bool of_covariates = false;  ///< true: the chart requires a varying covariate
  int fewest_features = 1;
  /// Number of rows over which the running median of the statistic is taken, so that single
  /// outliers raise no alarm; 1: no median.
  int median_rows = 1;
  std::function<std::unique_ptr<ComparisonChart>(const Series& learning)> learn;
};

/// The charts, in the order of the list at the top of this file.
[[nodiscard]] const std::vector<ChartKind>& chart_kinds();

/// Smallest number of training rows with which charts use a running median
/// (ChartKind::median_rows).
inline constexpr int kFewestRowsForMedian = 200;

/// An alarm ends after this number of rows below the threshold.
inline constexpr int kRowsBelow = 24;

struct ChartFinding {
  std::string name;
  double threshold = 0.0;
  std::vector<double> statistic = {};  ///< per row after the training period; NaN: not computed
  std::vector<int> alarms = {};        ///< rows of the series in which an alarm began
};

/// Runs all charts that are possible for the series. The first `learning_rows` rows train the
/// charts.
[[nodiscard]] std::vector<ChartFinding> run_charts(const Series& series, int learning_rows,
                                                   double rows_between_false_alarms, int threads);

/// The threshold that the statistic of healthy rows exceeds once in `rows_between` rows on average.
/// The maxima over blocks are assumed to follow a Gumbel distribution, P(maximum <= A) =
/// exp(-exp(-(A - m)/s)), fitted by L-moments (Hosking 1990).
[[nodiscard]] double chart_threshold(const std::vector<double>& healthy, double rows_between);

/// Returns the rows in which an alarm begins.
[[nodiscard]] std::vector<int> chart_alarms(const std::vector<double>& statistic, double threshold);

}  // namespace wheeltap::identification::monitoring
