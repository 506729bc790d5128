// Control charts from the literature, to compare Wheeltap's detector with:
//
//   Hotelling's T² of the features and of their residuals about a regression on the covariates,
//   the squared prediction error of principal components (Yan et al. 2005),
//   the residual of cointegration (Cross, Worden & Chen 2011),
//   T² of the residuals of Gaussian process regression on the covariates,
//   CUSUM (Page 1954) and multivariate EWMA (Lowry et al. 1992) of the regression's residuals.
//
// Each chart learns from the rows that the baseline learns from. Its threshold is for the rate of
// false alarms that the case states: the chart learns from two thirds of the learning rows and runs
// over the remaining third, for each third in turn. The maxima over blocks of these rows give the
// threshold.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

/// A chart that has learned.
class ComparisonChart {
 public:
  virtual ~ComparisonChart() = default;
  /// The statistic of the next row, not negative; NaN where its features do not allow one.
  virtual double add(const Row& row) = 0;
};

struct ChartKind {
  std::string name;
  bool of_covariates = false;  ///< exists only where a covariate varies
  int fewest_features = 1;
  /// Rows over which the median of the statistic is taken; 1: none. Single outliers then raise no
  /// alarm.
  int median_rows = 1;
  std::function<std::unique_ptr<ComparisonChart>(const Series& learning)> learn;
};

/// The charts, in the order of the list above.
[[nodiscard]] const std::vector<ChartKind>& chart_kinds();

/// Charts of short series take no median: see ChartKind::median_rows.
inline constexpr int kFewestRowsForMedian = 200;

/// An alarm ends after this many rows below the threshold.
inline constexpr int kRowsBelow = 24;

struct ChartFinding {
  std::string name;
  double threshold = 0.0;
  std::vector<double> statistic = {};  ///< rows after learning; NaN: none
  std::vector<int> alarms = {};        ///< rows of the series in which an alarm began
};

/// Runs every chart that the series allows. The first `learning_rows` rows are healthy.
[[nodiscard]] std::vector<ChartFinding> run_charts(const Series& series, int learning_rows,
                                                   double rows_between_false_alarms, int threads);

/// The threshold that healthy values exceed once in `rows_between` rows. The maxima over blocks
/// follow a Gumbel distribution, P(maximum <= A) = exp(-exp(-(A - m)/s)), by its L-moments (Hosking
/// 1990).
[[nodiscard]] double chart_threshold(const std::vector<double>& healthy, double rows_between);

/// Rows in which an alarm begins.
[[nodiscard]] std::vector<int> chart_alarms(const std::vector<double>& statistic, double threshold);

}  // namespace wheeltap::identification::monitoring
