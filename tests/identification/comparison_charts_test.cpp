#include "identification/monitoring/charts/comparison_charts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "identification/monitoring/charts/cointegration.hpp"
#include "identification/monitoring/residual_scatter.hpp"
#include "identification/monitoring/weather_regression.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Three features of one temperature with a change of slope at zero; from `onset` on the second is
/// lower by `shift`.
Series weather_series(int n, int onset, double shift, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  Series out{.features = MatrixXd(n, 3),
             .covariates = MatrixXd(n, 1),
             .feature_names = {"f1", "f2", "f3"},
             .covariate_names = {"air"}};
  double slow = 0.0;
  for (int t = 0; t < n; ++t) {
    slow = 0.98 * slow + 1.2 * random.normal();
    const double air = 3.0 + 6.0 * std::sin(kTwoPi * t / 24.0) + slow;
    out.hours.push_back(t);
    out.covariates(t, 0) = air;
    for (Index j = 0; j < 3; ++j) {
      out.features(t, j) = 1.0 + static_cast<double>(j) - 0.001 * air +
                           0.004 * std::max(0.0, -air) + 0.002 * random.normal();
      if (j == 1 && t >= onset) out.features(t, j) -= shift;
      if (random.uniform() < 0.05) out.features(t, j) = kNaN;
    }
  }
  return out;
}

TEST(Cointegration, FindsTheCombinationThatIsStationary) {
  base::Random random(2, 0, 0, base::Purpose::test);
  MatrixXd levels(3000, 3);
  double walk = 0.0, other = 0.0;
  for (Index t = 0; t < levels.rows(); ++t) {
    walk += random.normal();
    other += random.normal();
    levels(t, 0) = walk;
    levels(t, 1) = other;
    levels(t, 2) = 2.0 * walk - 0.5 * other + random.normal();
  }
  const VectorXd b = cointegrating_vector(levels);
  // The estimate's error is of the order 1/n; the noise over the walk's size gives the factor.
  EXPECT_NEAR(b[0] / b[2], -2.0, 0.05);
  EXPECT_NEAR(b[1] / b[2], 0.5, 0.05);
}

TEST(Scatter, DistanceLeavesOutMissingEntries) {
  base::Random random(4, 0, 0, base::Purpose::test);
  MatrixXd residuals(20000, 2);
  for (Index t = 0; t < residuals.rows(); ++t) {
    residuals(t, 0) = random.normal();
    residuals(t, 1) = 0.6 * residuals(t, 0) + 0.8 * random.normal();
  }
  const Scatter scatter = robust_scatter(residuals);
  EXPECT_NEAR(scatter.sd[0], 1.0, 0.04);
  // Clipping at three standard deviations takes little from a correlation of 0.6.
  EXPECT_NEAR(scatter.covariance(0, 1), 0.6, 0.05);
  EXPECT_NEAR(squared_distance(scatter, Eigen::Vector2d(2.0, kNaN)), 4.0, 0.4);
  EXPECT_NEAR(squared_distance(scatter, Eigen::Vector2d(1.0, 0.6)), 1.0, 0.1);
  EXPECT_TRUE(std::isnan(squared_distance(scatter, Eigen::Vector2d(kNaN, kNaN))));
}

TEST(HingeRegression, RemovesAChangeOfSlopeAtZero) {
  const Series series = weather_series(2000, 5000, 0.0, 3);
  const HingeRegression regression(series.first(1500));
  double squares = 0.0;
  int n = 0;
  for (int t = 1500; t < 2000; ++t)
    for (const double r : regression.residuals(row_of(series, t, {})))
      if (std::isfinite(r)) squares += r * r, ++n;
  EXPECT_NEAR(std::sqrt(squares / n), 0.002, 0.0002);  // the noise
}

TEST(ProcessRegression, StandardisedResidualsHaveUnitVariance) {
  const Series series = weather_series(2000, 5000, 0.0, 4);
  const ProcessRegression regression(series.first(1500));
  double squares = 0.0;
  int n = 0;
  for (int t = 1500; t < 2000; ++t)
    for (const double r : regression.residuals(row_of(series, t, {})))
      if (std::isfinite(r)) squares += r * r, ++n;
  // The noise is the best of a grid whose steps are factors of three in its variance ratio.
  EXPECT_NEAR(std::sqrt(squares / n), 1.0, 0.25);
}

/// Exponential values: P(maximum of 24 > A) is about 24 exp(-A).
TEST(ChartThreshold, ExtrapolatesToTheAskedRate) {
  base::Random random(6, 0, 0, base::Purpose::test);
  std::vector<double> healthy(24000);
  for (double& x : healthy) x = -std::log(random.uniform());
  const double threshold = chart_threshold(healthy, 1e5);
  // 1000 maxima: the scale is known to about 1/√1000 of its value, over ln(1e5/24) = 8.3 of them.
  EXPECT_NEAR(threshold, std::log(1e5), 4.0 * 8.3 / std::sqrt(1000.0));
}

TEST(ChartAlarms, BeginAnewOnlyAfterRowsBelow) {
  std::vector<double> statistic(100, 0.0);
  for (const std::size_t t : {30, 31, 40, 80}) statistic[t] = 5.0;
  statistic[35] = kNaN;
  EXPECT_EQ(chart_alarms(statistic, 1.0), (std::vector<int>{30, 80}));
}

TEST(ComparisonCharts, FindAShiftAndNothingBefore) {
  const int learning = 1000, onset = 1500;
  const Series series = weather_series(1900, onset, 0.03, 8);
  const auto charts = run_charts(series, learning, 20000.0, 1);
  ASSERT_EQ(charts.size(), chart_kinds().size());
  for (const ChartFinding& chart : charts) {
    EXPECT_EQ(chart.statistic.size(), 900U) << chart.name;
    ASSERT_FALSE(chart.alarms.empty()) << chart.name;
    EXPECT_GE(chart.alarms[0], onset) << chart.name;
    EXPECT_LE(chart.alarms[0], onset + 48) << chart.name;
  }
}

TEST(ComparisonCharts, LeaveOutWhatTheSeriesDoesNotAllow) {
  Series series = weather_series(300, 500, 0.0, 9);
  series.features.conservativeResize(Eigen::NoChange, 1);
  series.covariates.resize(300, 0);
  std::vector<std::string> names;
  for (const ChartFinding& chart : run_charts(series, 200, 1000.0, 1)) names.push_back(chart.name);
  EXPECT_EQ(names, (std::vector<std::string>{"T² of features", "CUSUM", "EWMA"}));
}

}  // namespace
}  // namespace wheeltap::identification::monitoring
