#include "inference/statistics/grouped_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// Groups y_w with precision h_w of one location z: ln p = -½ h_w (y_w - z)². About the estimate z*
/// = Σ h y / Σ h under a flat prior.
std::vector<GroupScore> of_location(const std::vector<double>& y, const std::vector<double>& h) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t w = 0; w < y.size(); ++w) sum += h[w] * y[w], weight += h[w];
  std::vector<GroupScore> out;
  for (std::size_t w = 0; w < y.size(); ++w) {
    out.push_back(
        {VectorXd::Constant(1, h[w] * (y[w] - sum / weight)), MatrixXd::Constant(1, 1, h[w])});
  }
  return out;
}

const MatrixXd kFlat = MatrixXd::Zero(1, 1);

// The jackknife of a mean is s/√N exactly, and that of a weighted mean agrees with omitting each
// group.
TEST(GroupedErrors, MatchTheStandardErrorOfAMean) {
  const std::vector<double> y = {1.0, 4.0, -2.0, 0.5, 3.0, -1.0};
  const auto errors = grouped_errors(of_location(y, std::vector<double>(6, 50.0)), kFlat);
  double mean = 0.0, squares = 0.0;
  for (const double x : y) mean += x / 6.0;
  for (const double x : y) squares += (x - mean) * (x - mean);
  EXPECT_NEAR(errors[0].sd, std::sqrt(squares / 5.0 / 6.0), 1e-12);
  EXPECT_DOUBLE_EQ(errors[0].quantile(0.5), 0.0);

  const std::vector<double> h = {10.0, 40.0, 5.0, 20.0, 20.0, 60.0};
  const auto without = [&](std::size_t left_out) {
    double sum = 0.0, weight = 0.0;
    for (std::size_t w = 0; w < 6; ++w) {
      if (w != left_out) sum += h[w] * y[w], weight += h[w];
    }
    return sum / weight;
  };
  double left_out = 0.0;
  for (std::size_t w = 0; w < 6; ++w) left_out += std::pow(without(w) - without(6), 2);
  EXPECT_NEAR(grouped_errors(of_location(y, h), kFlat)[0].sd, std::sqrt(5.0 / 6.0 * left_out),
              1e-12);
}

// Two groups can be resampled in one way only: the interval is Student's t with one degree of
// freedom.
TEST(GroupedErrors, AreStudentsTForTwoGroups) {
  const auto errors = grouped_errors(of_location({0.0, 1.0}, {1e4, 1e4}), kFlat);
  EXPECT_NEAR(errors[0].sd, 0.5, 1e-12);
  EXPECT_NEAR(errors[0].quantile(0.95), 0.5 * 6.313752, 1e-5);
  EXPECT_NEAR(errors[0].quantile(0.05), -0.5 * 6.313752, 1e-5);
}

// For groups that agree, the error is that of the information.
TEST(GroupedErrors, AreAtLeastThoseOfTheInformation) {
  const auto errors = grouped_errors(of_location({2.0, 2.0, 2.0, 2.0}, {4, 4, 4, 4}), kFlat);
  EXPECT_DOUBLE_EQ(errors[0].sd, 0.25);
}

// Random weights correlated with the values, as for large amplitudes with stiffening: z∞ = E h y /
// E h. The 90 % intervals cover it; Student's with the sandwich error (the control) do not. 1000
// repetitions; the tolerance is four standard deviations of a binomial (0.038).
TEST(GroupedErrors, CoverIfInfluentialGroupsDominate) {
  constexpr int kRepetitions = 1000, kGroups = 8;
  int held = 0, control = 0;
  for (int r = 0; r < kRepetitions; ++r) {
    base::Random random(3, static_cast<std::uint64_t>(r), 0, base::Purpose::test);
    std::vector<double> y, h;
    for (int w = 0; w < kGroups; ++w) {
      double loud = 0.0;  // sum of three exponentials: mean 3, mean square 12
      for (int k = 0; k < 3; ++k) loud -= std::log(random.uniform());
      h.push_back(1e6 * loud);
      y.push_back(loud + 0.1 * random.normal());
    }
    const double truth = 12.0 / 3.0;
    double sum = 0.0, weight = 0.0, sandwich = 0.0;
    for (std::size_t w = 0; w < y.size(); ++w) sum += h[w] * y[w], weight += h[w];
    const double z = sum / weight;
    for (std::size_t w = 0; w < y.size(); ++w) sandwich += std::pow(h[w] * (y[w] - z) / weight, 2);
    const auto error = grouped_errors(of_location(y, h), kFlat, {.resamples = 500})[0];
    held += z + error.quantile(0.05) < truth && truth < z + error.quantile(0.95) ? 1 : 0;
    constexpr double kT = 1.894579;  // quantile for 7 degrees of freedom, 95 %
    control += std::abs(truth - z) < kT * std::sqrt(sandwich * 8.0 / 7.0) ? 1 : 0;
  }
  EXPECT_GE(held, (0.85 - 0.038) * kRepetitions);
  EXPECT_LE(held, (0.95 + 0.038) * kRepetitions);
  EXPECT_LT(control, held - 0.038 * kRepetitions);
}

TEST(GroupedErrors, RejectInvalidInput) {
  EXPECT_THROW(static_cast<void>(grouped_errors(of_location({1.0}, {1.0}), kFlat)),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(
                   grouped_errors(of_location({1.0, 2.0}, {1.0, 1.0}), MatrixXd::Identity(2, 2))),
               std::invalid_argument);
  EXPECT_TRUE(grouped_errors(of_location({1.0, 2.0}, {1.0, -3.0}), kFlat).empty());
}

}  // namespace
}  // namespace wheeltap::inference
