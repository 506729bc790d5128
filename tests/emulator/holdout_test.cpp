#include "emulator/holdout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wheeltap::emulator {
namespace {

TEST(Holdout, KnownErrors) {
  RowMatrix truth(4, 2), predicted(4, 2);
  truth << 1, 5, 2, 5, 3, 5, 4, 5;
  predicted << 1.5, 5, 2, 5, 3, 5, 3, 5;
  const auto errors = holdout_error(truth, predicted);
  EXPECT_DOUBLE_EQ(errors[0].rmse, std::sqrt(1.25 / 4));
  EXPECT_DOUBLE_EQ(errors[0].max_error, 1.0);
  EXPECT_DOUBLE_EQ(errors[0].spread, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(errors[0].q2, 1 - 1.25 / 5);
  EXPECT_DOUBLE_EQ(errors[0].relative_rmse(), 0.5);
  EXPECT_TRUE(errors[0].cannot_be_predicted());
  EXPECT_EQ(errors[1].q2, 1.0) << "a constant response predicted exactly";
  EXPECT_FALSE(errors[1].cannot_be_predicted());
  predicted(0, 1) = 5.1;
  EXPECT_TRUE(holdout_error(truth, predicted)[1].cannot_be_predicted());
}

TEST(Holdout, PredictingTheMeanScoresZero) {
  const std::vector<Factor> line = {{"x", "", {0, 1}}};
  const ModelFactory model = [] {
    return [](std::span<const double> x, std::span<double> y) { y[0] = x[0]; };
  };
  const Predictor mean = [](std::span<const double>, std::span<double> y) { y[0] = 0.5; };
  const auto errors = validate(line, 1, model, mean, {.runs = 4000, .seed = 5});
  // The sample mean of n uniform points is 0.5 ± 1/√(12 n), so Q² = -(ȳ-½)²/s² = O(1/n).
  EXPECT_NEAR(errors[0].q2, 0.0, 16.0 / 4000);
  EXPECT_NEAR(errors[0].spread, std::sqrt(1.0 / 12), 0.01);
  EXPECT_TRUE(errors[0].cannot_be_predicted());
}

TEST(Holdout, KnownQ2OfANoisyPredictor) {
  // ŷ = x + 0.1 cos(40πx): error variance 0.005, effect variance 1/12, Q² = 1 - 0.06.
  const std::vector<Factor> line = {{"x", "", {0, 1}}};
  const ModelFactory model = [] {
    return [](std::span<const double> x, std::span<double> y) { y[0] = x[0]; };
  };
  const Predictor wavy = [](std::span<const double> x, std::span<double> y) {
    y[0] = x[0] + 0.1 * std::cos(40 * M_PI * x[0]);
  };
  const auto e = validate(line, 1, model, wavy, {.runs = 20000, .seed = 9})[0];
  // sd of the mean of cos² over n points is √(1/8n), and of (x-½)² √(1/180n).
  const double tolerance = 0.06 * 5 * (std::sqrt(0.5 / 20000) + std::sqrt(0.8 / 20000));
  EXPECT_NEAR(e.q2, 0.94, tolerance);
  EXPECT_FALSE(e.cannot_be_predicted());
  EXPECT_LE(e.max_error, 0.1);
}

TEST(Holdout, DependsOnTheSeedAndNotOnThreads) {
  const std::vector<Factor> line = {{"x", "", {0, 1}}};
  const ModelFactory model = [] {
    return [](std::span<const double> x, std::span<double> y) { y[0] = x[0] * x[0]; };
  };
  const Predictor zero = [](std::span<const double>, std::span<double> y) { y[0] = 0; };
  const auto rmse = [&](int threads, std::uint64_t seed) {
    return validate(line, 1, model, zero,
                    {.runs = 50, .seed = seed, .experiment = {.threads = threads}})[0]
        .rmse;
  };
  EXPECT_EQ(rmse(1, 3), rmse(4, 3));
  EXPECT_NE(rmse(1, 3), rmse(1, 4));
}

TEST(StandardisedResiduals, KnownValues) {
  RowMatrix truth(4, 2), mean = RowMatrix::Zero(4, 2), variance(4, 2);
  truth << 1, 0, -3, 0, 2, 0, 0, 5;
  variance << 1, 0, 1, 0, 4, 0, 1, 0;
  const auto z = standardised_residuals(truth, mean, variance);  // 1, -3, 1, 0
  EXPECT_DOUBLE_EQ(z[0].mean, -0.25);
  EXPECT_DOUBLE_EQ(z[0].rms, std::sqrt(11.0 / 4));
  EXPECT_DOUBLE_EQ(z[0].beyond_two, 0.25);
  EXPECT_TRUE(std::isinf(z[1].rms)) << "an error where none was admitted";
  EXPECT_THROW((void)standardised_residuals(truth, mean, RowMatrix::Zero(4, 1)),
               std::invalid_argument);
}

TEST(Holdout, RejectsInvalidInput) {
  EXPECT_THROW((void)holdout_error(RowMatrix::Zero(3, 2), RowMatrix::Zero(3, 1)),
               std::invalid_argument);
  EXPECT_THROW((void)holdout_error(RowMatrix::Zero(1, 2), RowMatrix::Zero(1, 2)),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
