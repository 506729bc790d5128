// Mean and scatter of repeated tests: exact posteriors, coverage, outliers, missing frequencies and
// invalid input.
#include "identification/structural/repeated_tests.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNormal = std::numeric_limits<double>::infinity();

/// TestSeries tests of three modes with correlated errors.
struct TestSeries {
  VectorXd frequencies_hz = VectorXd{{10.0, 25.0, 60.0}};
  VectorXd scatter = VectorXd{{0.002, 0.004, 0.01}};
  double nu = kNormal;    ///< degrees of freedom of Student t
  double outliers = 0.0;  ///< probability of an error eight times as large
  double missing = 0.0;   ///< probability that a test does not identify a mode
  double serial = 0.0;    ///< correlation of consecutive tests

  [[nodiscard]] MatrixXd tests(int count, std::uint64_t seed) const {
    base::Random random(seed, 0, static_cast<std::uint64_t>(count), base::Purpose::test);
    const MatrixXd mixing{{1.0, 0.0, 0.0}, {0.6, 0.8, 0.0}, {0.3, 0.3, std::sqrt(0.82)}};
    MatrixXd out(count, 3);
    VectorXd state = VectorXd::Zero(3);
    for (int t = 0; t < count; ++t) {
      VectorXd error(3);
      for (double& x : error) x = random.normal();
      state = t == 0 ? error : VectorXd(serial * state + std::sqrt(1.0 - serial * serial) * error);
      error = mixing * state;
      if (std::isfinite(nu)) error /= std::sqrt(2.0 * random.gamma(0.5 * nu) / nu);
      if (random.uniform() < outliers) error *= 8.0;
      for (Index j = 0; j < 3; ++j) {
        out(t, j) = frequencies_hz[j] * std::exp(scatter[j] * error[j]);
        if (random.uniform() < missing) out(t, j) = kNaN;
      }
    }
    return out;
  }
};

double sd_of(const RepeatedTests& found, Index mode) {
  return std::sqrt(found.covariance_hz2(mode, mode));
}

double robust_scale(std::vector<double> values) {
  const auto median = [](std::vector<double> x) {
    std::ranges::sort(x);
    return 0.5 * (x[(x.size() - 1) / 2] + x[x.size() / 2]);
  };
  const double centre = median(values);
  for (double& x : values) x = std::abs(x - centre);
  return 1.4826 * median(values);
}

// Normal errors, nothing missing: μ is Student t with N degrees of freedom and the scale matrix
// (S + D) / N², so that its covariance is (S + D) / (N (N - 2)).
TEST(RepeatedTests, EqualTheConjugatePosterior) {
  const int n = 40;
  const MatrixXd tests = TestSeries{}.tests(n, 1), logs = tests.array().log();
  const RepeatedTests found = infer_repeated_tests(tests, {.degrees_of_freedom = {kNormal}});
  const VectorXd mean = logs.colwise().mean();
  const MatrixXd centred = logs.rowwise() - mean.transpose();
  MatrixXd squares = centred.transpose() * centred;
  for (Index j = 0; j < 3; ++j)
    squares(j, j) += std::pow(robust_scale({logs.col(j).begin(), logs.col(j).end()}), 2);
  for (Index i = 0; i < 3; ++i) {
    const double f = found.frequencies_hz[static_cast<std::size_t>(i)];
    EXPECT_NEAR(f, std::exp(mean[i]), 1e-10 * f);
    for (Index j = 0; j < 3; ++j)
      EXPECT_NEAR(
          found.covariance_hz2(i, j),
          f * found.frequencies_hz[static_cast<std::size_t>(j)] * squares(i, j) / (n * (n - 2.0)),
          1e-8 * sd_of(found, i) * sd_of(found, j));
    // Σ_ii ~ inverse gamma(N/2, squares_ii/2): E[√Σ_ii] = √(squares_ii/2) Γ((N-1)/2) / Γ(N/2)
    const double scatter = std::sqrt(0.5 * squares(i, i)) *
                           std::exp(std::lgamma(0.5 * (n - 1.0)) - std::lgamma(0.5 * n));
    const auto at = static_cast<std::size_t>(i);
    EXPECT_NEAR(found.scatter[at], scatter, 5.0 * found.scatter_sd[at] / std::sqrt(4000.0));
  }
}

// One mode with Student t errors: the posterior of (μ, ln σ) by quadrature.
TEST(RepeatedTests, EqualTheQuadratureOfOneMode) {
  const std::vector<double> y = {2.301, 2.3035, 2.2992, 2.3011, 2.2998, 2.33, 2.3005};
  const double nu = 3.0, s = robust_scale(y), centre = 2.301;
  MatrixXd tests(static_cast<Index>(y.size()), 1);
  for (std::size_t t = 0; t < y.size(); ++t) tests(static_cast<Index>(t), 0) = std::exp(y[t]);
  double sum = 0.0, mean = 0.0, square = 0.0, scatter = 0.0;
  for (double log_sigma = std::log(s) - 4.0; log_sigma < std::log(s) + 6.0; log_sigma += 0.02)
    for (double mu = centre - 40.0 * s; mu < centre + 40.0 * s; mu += 0.02 * s) {
      const double sigma = std::exp(log_sigma);
      // Prior of Σ = σ²: inverse gamma(1/2, s²/2), i.e. density in ln σ ∝ σ⁻¹ exp(-s²/2σ²)
      double log_density = -log_sigma - 0.5 * s * s / (sigma * sigma);
      for (const double x : y)
        log_density -=
            log_sigma + 0.5 * (nu + 1.0) * std::log1p((x - mu) * (x - mu) / (nu * sigma * sigma));
      const double p = std::exp(log_density - 40.0);
      sum += p;
      mean += p * (mu - centre);
      square += p * (mu - centre) * (mu - centre);
      scatter += p * sigma;
    }
  mean /= sum;
  const double sd = std::sqrt(square / sum - mean * mean);
  const RepeatedTests found =
      infer_repeated_tests(tests, {.degrees_of_freedom = {nu}, .draws = 40000});
  EXPECT_NEAR(std::log(found.frequencies_hz[0]), centre + mean, 0.02 * sd);
  EXPECT_NEAR(sd_of(found, 0) / found.frequencies_hz[0], sd, 0.02 * sd);
  const double upper_quantile = 1.1968872;  // of Student t with 3 degrees of freedom, at Φ(1)
  EXPECT_NEAR(found.scatter[0], upper_quantile * scatter / sum, 0.02 * found.scatter[0]);
}

// Intervals of 90 % of means and scatters. With 200 data sets of three correlated modes, the
// observed share has a standard error of at most 2.1 %.
TEST(RepeatedTests, IntervalsHaveTheirCoverage) {
  const auto coverage = [](const TestSeries& simulated, double scatter_factor, bool scatters) {
    int means = 0, scales = 0;
    constexpr int kSets = 200;
    for (int set = 0; set < kSets; ++set) {
      const RepeatedTests found = infer_repeated_tests(
          simulated.tests(20, 100 + static_cast<std::uint64_t>(set)), {.warmup = 50, .draws = 350});
      for (std::size_t j = 0; j < 3; ++j) {
        const auto at = static_cast<Index>(j);
        const double error = found.frequencies_hz[j] - simulated.frequencies_hz[at];
        means += std::abs(error) < 1.645 * sd_of(found, at);
        scales += std::abs(found.scatter[j] - scatter_factor * simulated.scatter[at]) <
                  1.645 * found.scatter_sd[j];
      }
    }
    EXPECT_GE(means, 0.85 * 3 * kSets);
    EXPECT_LE(means, 0.95 * 3 * kSets);
    if (!scatters) return;
    EXPECT_GE(scales, 0.85 * 3 * kSets);
    EXPECT_LE(scales, 0.95 * 3 * kSets);
  };
  coverage({.nu = 3.0, .missing = 0.15}, 1.1968872, true);
  coverage({.missing = 0.15}, 1.0, true);
  coverage({.outliers = 0.08, .missing = 0.15}, 1.0, false);
}

TEST(RepeatedTests, OneOutlierBarelyMovesTheMean) {
  const MatrixXd clean = TestSeries{}.tests(40, 7);
  MatrixXd gross = clean;
  gross.row(12) *= 1.5;
  const RepeatedTests before = infer_repeated_tests(clean), after = infer_repeated_tests(gross);
  EXPECT_THAT(before.outliers, IsEmpty());
  EXPECT_THAT(after.outliers, ElementsAre(12));
  EXPECT_LT(after.weights[12], 0.01);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto at = static_cast<Index>(j);
    EXPECT_LT(std::abs(after.frequencies_hz[j] - before.frequencies_hz[j]),
              0.5 * sd_of(before, at));
    EXPECT_LT(sd_of(after, at), 1.5 * sd_of(before, at));
    EXPECT_LT(after.scatter[j], 1.5 * before.scatter[j]);
  }
}

TEST(RepeatedTests, DoNotDependOnTheOrderOfTests) {
  const MatrixXd tests = TestSeries{.nu = 3.0, .missing = 0.2}.tests(25, 3);
  std::vector<Index> order(25);
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::shuffle(order, std::mt19937(5));
  const RepeatedTests a = infer_repeated_tests(tests),
                      b = infer_repeated_tests(tests(order, Eigen::all));
  ASSERT_THAT(a.inflation, testing::Each(1.0));
  ASSERT_THAT(b.inflation, testing::Each(1.0));
  EXPECT_EQ(a.frequencies_hz, b.frequencies_hz);
  EXPECT_EQ(a.covariance_hz2, b.covariance_hz2);
  EXPECT_EQ(a.scatter, b.scatter);
  for (std::size_t t = 0; t < order.size(); ++t)
    EXPECT_EQ(b.weights[t], a.weights[static_cast<std::size_t>(order[t])]);
}

TEST(RepeatedTests, FourTimesTheTestsHalveTheError) {
  double ratio = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TestSeries simulated;
    const RepeatedTests few = infer_repeated_tests(simulated.tests(40, seed)),
                        many = infer_repeated_tests(simulated.tests(160, seed));
    for (Index j = 0; j < 3; ++j)
      ratio += sd_of(many, j) / std::sqrt(many.inflation[static_cast<std::size_t>(j)]) /
               (sd_of(few, j) / std::sqrt(few.inflation[static_cast<std::size_t>(j)])) / 30.0;
  }
  EXPECT_NEAR(ratio, 0.5, 0.04);
}

// Missing frequencies are predicted from the correlated mode: for normal errors, the mean of the
// second mode is about that of the regression estimate (Anderson 1957).
TEST(RepeatedTests, UseTheCorrelationForMissingFrequencies) {
  const int n = 200;
  MatrixXd tests(n, 2);
  base::Random random(11, 0, 0, base::Purpose::test);
  for (int t = 0; t < n; ++t) {
    const double common = random.normal();
    tests(t, 0) = 10.0 * std::exp(0.01 * common);
    tests(t, 1) = 30.0 * std::exp(0.01 * (common + 0.1 * random.normal()));
    if (common > 0.0) tests(t, 1) = kNaN;  // depends on the first mode, which is known
  }
  VectorXd x(n), y(n);
  Index known = 0;
  double all = 0.0;
  for (int t = 0; t < n; ++t) {
    all += std::log(tests(t, 0)) / n;
    if (std::isnan(tests(t, 1))) continue;
    x[known] = std::log(tests(t, 0));
    y[known++] = std::log(tests(t, 1));
  }
  const VectorXd dx = x.head(known).array() - x.head(known).mean();
  const double slope = dx.dot(y.head(known)) / dx.squaredNorm();
  const double regression = y.head(known).mean() + slope * (all - x.head(known).mean());
  const RepeatedTests found = infer_repeated_tests(tests, {.degrees_of_freedom = {kNormal}});
  EXPECT_NEAR(std::log(found.frequencies_hz[1]), regression, 2e-4);
  EXPECT_GT(std::log(found.frequencies_hz[1]), y.head(known).mean() + 0.005);
  EXPECT_EQ(found.identified[1], static_cast<int>(known));
}

TEST(RepeatedTests, SerialCorrelationWidensTheError) {
  int covered = 0, independent = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const TestSeries simulated{.serial = 0.8};
    const RepeatedTests found =
        infer_repeated_tests(simulated.tests(60, seed), {.warmup = 100, .draws = 300});
    for (std::size_t j = 0; j < 3; ++j) {
      const auto at = static_cast<Index>(j);
      const double error = std::abs(found.frequencies_hz[j] - simulated.frequencies_hz[at]);
      covered += error < 1.645 * sd_of(found, at);
      independent += error < 1.645 * sd_of(found, at) / std::sqrt(found.inflation[j]);
    }
  }
  EXPECT_GE(covered, 0.80 * 180);
  EXPECT_LE(independent, 0.60 * 180);
}

TEST(RepeatedTests, KeepTheNumberOfAModeThatNoTestIdentified) {
  MatrixXd tests = TestSeries{}.tests(12, 2);
  tests.col(1).setConstant(kNaN);
  const RepeatedTests found = infer_repeated_tests(tests);
  EXPECT_THAT(found.identified, ElementsAre(12, 0, 12));
  EXPECT_TRUE(std::isnan(found.frequencies_hz[1]) && std::isnan(found.scatter[1]));
  EXPECT_NEAR(found.frequencies_hz[2], 60.0, 1.0);
  EXPECT_EQ(found.covariance_hz2.row(1).cwiseAbs().maxCoeff(), 0.0);
}

TEST(RepeatedTests, MoreModesThanTests) {
  base::Random random(3, 0, 0, base::Purpose::test);
  MatrixXd tests(5, 12);
  for (Index t = 0; t < 5; ++t)
    for (Index j = 0; j < 12; ++j)
      tests(t, j) = (5.0 + 3.0 * static_cast<double>(j)) * std::exp(0.01 * random.normal());
  const RepeatedTests found = infer_repeated_tests(tests);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(found.covariance_hz2);
  EXPECT_GT(eigen.eigenvalues()[0], 0.0);
}

TEST(RepeatedTests, RejectInvalidTests) {
  const auto complaint = [](const MatrixXd& tests) -> std::string {
    try {
      static_cast<void>(infer_repeated_tests(tests));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const MatrixXd tests = TestSeries{}.tests(6, 1);
  EXPECT_EQ(complaint(tests), "");
  EXPECT_THAT(complaint(tests.topRows(3)), HasSubstr("mode 1 was identified in 3 tests"));
  MatrixXd changed = tests;
  changed(2, 1) = -1.0;
  EXPECT_THAT(complaint(changed), HasSubstr("mode 2: frequencies must be > 0"));
  changed = tests;
  changed.col(2).setConstant(60.0);
  EXPECT_THAT(complaint(changed), HasSubstr("mode 3 has the same frequency in all tests"));
  MatrixXd rare = TestSeries{}.tests(200, 1);
  rare.col(1).tail(195).setConstant(kNaN);
  EXPECT_THAT(complaint(rare), HasSubstr("mode 2 was identified in 5 of 200 tests"));
  changed.setConstant(kNaN);
  EXPECT_THAT(complaint(changed), HasSubstr("no test identified a mode"));
  // Rounded frequencies: most of them are equal.
  changed = tests;
  changed.col(0) << 10.0, 10.0, 10.0, 10.0, 10.1, 10.0;
  EXPECT_EQ(complaint(changed), "");
}

}  // namespace
}  // namespace wheeltap::identification
