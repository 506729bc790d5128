// Records y_i ~ N(a, 1) with a ~ N(0, 10²): the posterior of n samples is normal,
//
//   precision n + 1/100,   mean Σ y / (n + 1/100).
#include "inference/exploration/starting_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/random.hpp"
#include "inference/statistics/standard_normal.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference::starting_points_test {
namespace {

constexpr int kSamples = 30000;
constexpr double kWidth = 10.0, kTruth = 7.0;

const std::vector<double>& record() {
  static const auto samples = [] {
    base::Random random(71, 0, 0, base::Purpose::test);
    std::vector<double> y(kSamples);
    for (double& value : y) value = kTruth + random.normal();
    return y;
  }();
  return samples;
}

// The second model is impossible if `broken`.
Problem level(long samples, bool broken) {
  const double n = static_cast<double>(samples);
  double sum = 0.0, squares = 0.0;
  for (long i = 0; i < samples; ++i) {
    const double y = record()[static_cast<std::size_t>(i)];
    sum += y;
    squares += y * y;
  }
  return {
      .space = ModelSpace::of_models({{"a", Normal{0.0, kWidth}}},
                                     {{"level", 1.0, {"a"}}, {"doubled", 1.0, {"a"}}}),
      .likelihood =
          [=] {
            return std::make_unique<FunctionLikelihood>([=](int model, std::span<const double> x) {
              if (model == 1 && broken) return -HUGE_VAL;
              const double a = model == 0 ? x[0] : 2.0 * x[0];
              return -n * kLogSqrt2Pi - 0.5 * (squares - 2.0 * a * sum + n * a * a);
            });
          },
      .samples = samples,
      .shortened =
          [broken](long first) { return std::make_shared<const Problem>(level(first, broken)); }};
}

std::vector<Laplace> climb(const Problem& problem, Options options = {}) {
  options.seed = 3;
  options.threads = 2;
  ProgressMonitor monitor(options, problem.space.size());
  return climb_with_record(problem, options, monitor);
}

// Regression: the evidence of a model without parameters was NaN.
TEST(StartingPoints, AModelWithoutParametersNeedsNone) {
  const auto problem = [](auto self, long samples) -> Problem {
    return {.space = ModelSpace::of_models({{"a", Normal{0.0, kWidth}}},
                                           {{"known", 1.0, {}}, {"level", 1.0, {"a"}}}),
            .likelihood =
                [=] {
                  return std::make_unique<FunctionLikelihood>([=](int, std::span<const double> x) {
                    const double a = x.empty() ? kTruth : x[0];
                    return -0.5 * static_cast<double>(samples) * (a - kTruth) * (a - kTruth);
                  });
                },
            .samples = samples,
            .shortened =
                [self](long first) { return std::make_shared<const Problem>(self(self, first)); }};
  };
  const auto modes = climb(problem(problem, kSamples));
  EXPECT_DOUBLE_EQ(modes[0].evidence.log_evidence, 0.0);
  EXPECT_TRUE(std::isfinite(modes[1].evidence.log_evidence));
}

TEST(StartingPoints, AreTheModesForTheWholeRecord) {
  const auto modes = climb(level(kSamples, false));
  ASSERT_EQ(modes.size(), 2U);
  const double sum = std::accumulate(record().begin(), record().end(), 0.0);
  for (const double scale : {1.0, 2.0}) {
    const Laplace& mode = modes[scale == 1.0 ? 0 : 1];
    const double precision = scale * scale * kSamples + 1.0 / (kWidth * kWidth);
    ASSERT_EQ(mode.x.size(), 1U);
    // From 5000 samples alone it would be about √(1/5000 - 1/30000) = 0.013 away: two standard
    // deviations of the whole record's posterior, 0.0058.
    EXPECT_NEAR(mode.x[0], scale * sum / precision, 1e-3 / std::sqrt(precision));
    // In standard normal coordinates; differences of ln π of 1e5 lose accuracy.
    EXPECT_NEAR(mode.covariance(0, 0) * precision * kWidth * kWidth, 1.0, 1e-3);
    EXPECT_TRUE(std::isfinite(mode.evidence.log_evidence));
    EXPECT_GT(mode.evidence.likelihood_evaluations, 0);
  }
}

TEST(StartingPoints, AreMissingForAnImpossibleModel) {
  const auto modes = climb(level(kSamples, true));
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_TRUE(std::isfinite(modes[0].evidence.log_evidence));
  EXPECT_TRUE(std::isnan(modes[1].evidence.log_evidence));
}

TEST(StartingPoints, AreMissingIfTheCallerStopsAtOnce) {
  const auto modes =
      climb(level(kSamples, false), {.progress = [](const Options::Progress&) { return false; }});
  for (const Laplace& mode : modes) EXPECT_TRUE(std::isnan(mode.evidence.log_evidence));
}

}  // namespace
}  // namespace wheeltap::inference::starting_points_test
