#include "identification/monitoring/series_simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wheeltap::identification::monitoring {
namespace {

SeriesTruth quiet_year() {
  SeriesTruth truth{.features = {{.value = 4.0, .noise_sd = 0.0, .drift_sd = 0.0},
                                 {.value = 7.0, .noise_sd = 0.0, .drift_sd = 0.0}},
                    .thermometers = {{.noise_sd = 0.0}}};
  return truth;
}

TEST(SeriesSimulation, FollowsTheEquationOfItsHeader) {
  const SeriesTruth truth = quiet_year();
  const Series year = simulate_series(truth, 1);
  double least = 100.0, most = -100.0;
  for (int t = 0; t < year.rows(); ++t) {
    const double air = year.covariates(t, 0);
    least = std::min(least, air);
    most = std::max(most, air);
    ASSERT_NEAR(year.features(t, 1),
                std::log(7.0) - 0.0005 * (air - 10.0) - 0.0025 * std::min(0.0, air), 1e-12);
  }
  EXPECT_LT(least, 0.0);
  EXPECT_GT(most, 20.0);
}

TEST(SeriesSimulation, ChangesBeginAtTheirInstant) {
  SeriesTruth truth = quiet_year();
  const Series before = simulate_series(truth, 1);
  truth.changes = {{.hours = 100.0, .shift = Eigen::Vector2d(0.0, -0.01)},
                   {.hours = 200.0, .ramp_hours = 100.0, .offset = Eigen::VectorXd::Ones(1)}};
  const Series after = simulate_series(truth, 1);
  EXPECT_EQ(before.features.topRows(100), after.features.topRows(100));
  EXPECT_NEAR(after.features(100, 1) - before.features(100, 1), -0.01, 1e-12);
  EXPECT_EQ(after.features(100, 0), before.features(100, 0));
  EXPECT_NEAR(after.covariates(250, 0) - before.covariates(250, 0), 0.5, 1e-12);
  EXPECT_NEAR(after.covariates(400, 0) - before.covariates(400, 0), 1.0, 1e-12);
}

// 8766 entries: the share of missing ones has a standard error of 0.005.
TEST(SeriesSimulation, MissingEntriesLeaveTheOthersUnchanged) {
  SeriesTruth truth = quiet_year();
  for (FeatureTruth& f : truth.features) f.noise_sd = f.drift_sd = 0.002;
  truth.outlier_share = 0.02;
  truth.noise_degrees = 4.0;
  const Series whole = simulate_series(truth, 9);
  truth.missing_share = 0.3;
  const Series part = simulate_series(truth, 9);
  int missing = 0;
  for (int t = 0; t < part.rows(); ++t) {
    if (std::isnan(part.features(t, 0)))
      ++missing;
    else
      ASSERT_EQ(part.features(t, 0), whole.features(t, 0));
  }
  EXPECT_NEAR(missing / 8766.0, 0.3, 3.3 * 0.005);
  EXPECT_EQ(part.covariates, whole.covariates);
}

TEST(SeriesSimulation, DriftHasItsStandardDeviationAndCorrelation) {
  SeriesTruth truth = quiet_year();
  truth.rows = 60000;
  truth.drift_hours = 5.0;
  truth.drift_correlation = 0.6;
  for (FeatureTruth& f : truth.features)
    f = {.slope = 0.0, .frost = 0.0, .noise_sd = 0.0, .drift_sd = 0.01};
  const Series found = simulate_series(truth, 4);
  const Eigen::VectorXd a = found.features.col(0).array() - found.features.col(0).mean();
  const Eigen::VectorXd b = found.features.col(1).array() - found.features.col(1).mean();
  const double n = 60000.0;
  // 6000 independent values: the standard error of an sd is 0.9 %.
  EXPECT_NEAR(a.norm() / std::sqrt(n), 0.01, 0.0004);
  EXPECT_NEAR(a.dot(b) / (a.norm() * b.norm()), 0.6, 0.04);
}

}  // namespace
}  // namespace wheeltap::identification::monitoring
