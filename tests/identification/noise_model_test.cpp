#include "identification/structural/likelihood/noise_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace wheeltap::identification {
namespace {

FrequencyData two_of_three() {
  FrequencyData data;
  data.frequencies_hz = {10.0, std::numeric_limits<double>::quiet_NaN(), 30.0};
  data.sd_hz = {0.1, std::numeric_limits<double>::quiet_NaN(), 0.3};
  data.discrepancy_cv = 0.02;
  return data;
}

double log_normal_density(double x, double mean, double sd) {
  return -0.5 * std::pow((x - mean) / sd, 2.0) - std::log(sd) -
         0.5 * std::log(2.0 * std::numbers::pi);
}

TEST(NoiseModel, AddsItsThreeVariances) {
  const FrequencyData data = two_of_three();
  const NoiseModel noise(data);
  EXPECT_NEAR(noise.sd(0, 0.0, 0.04), std::sqrt(0.01 + 0.04 + 0.04), 1e-15);
  EXPECT_NEAR(noise.sd(2, 0.0, 0.0), std::sqrt(0.09 + 0.36), 1e-15);
}

TEST(NoiseModel, LikelihoodIsThatOfTheMeasuredModes) {
  const FrequencyData data = two_of_three();
  const NoiseModel noise(data);
  const std::vector<double> predicted = {10.2, 20.0, 29.0}, variance = {0.04, 0.0, 0.0};
  std::vector<double> residuals;
  const double expected = log_normal_density(10.0, 10.2, noise.sd(0, 0.0, 0.04)) +
                          log_normal_density(30.0, 29.0, noise.sd(2, 0.0, 0.0));
  EXPECT_NEAR(noise.log_likelihood(predicted, variance, 0.0, residuals), expected, 1e-12);
  ASSERT_EQ(residuals.size(), 2U);
  EXPECT_NEAR(residuals[1], 1.0 / noise.sd(2, 0.0, 0.0), 1e-12);
}

// Regression: replicates had only the measurement's noise, so the report's bars contradicted its
// p-value.
TEST(NoiseModel, ReplicatesHaveTheNoiseOfTheLikelihood) {
  FrequencyData data = two_of_three();
  const NoiseModel known(data);
  EXPECT_EQ(known.replicate_sd(0, 10.7, 0.0, 0.04), known.sd(0, 0.0, 0.04));
  EXPECT_TRUE(std::isnan(known.replicate_sd(1, 20.0, 0.0, 0.0))) << "the accuracy is unknown";
  data.sd_hz.clear();
  data.cv_prior = inference::LogUniform{1e-4, 1e-1};
  const NoiseModel inferred(data);
  const std::vector<double> x = {0.01, 0.5};
  EXPECT_EQ(inferred.cv(x), 0.01);
  EXPECT_EQ(inferred.replicate_sd(0, 10.7, 0.01, 0.04), inferred.sd(0, 0.01, 0.04));
  // For a mode that was not measured, relative to the predicted frequency.
  EXPECT_NEAR(inferred.replicate_sd(1, 20.0, 0.01, 0.0), std::hypot(0.2, 0.4), 1e-15);
}

}  // namespace
}  // namespace wheeltap::identification
