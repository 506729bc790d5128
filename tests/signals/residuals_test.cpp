#include "signals/residuals.hpp"
#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace {

using namespace wheeltap::signals;

/// Autocorrelations of a stationary AR process with coefficients φ: extended from the Yule-Walker
/// equations by ρ_k = Σ φ_j ρ_{k-j}.
Eigen::VectorXd theoretical(const std::vector<double>& phi, int lags) {
  const auto p = static_cast<Eigen::Index>(phi.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(p, p);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(p);
  for (Eigen::Index k = 1; k <= p; ++k)
    for (Eigen::Index j = 1; j <= p; ++j) {
      const double value = phi[static_cast<std::size_t>(j - 1)];
      const Eigen::Index lag = std::abs(k - j);
      if (lag == 0)
        b(k - 1) += value;
      else
        a(k - 1, lag - 1) -= value;
    }
  Eigen::VectorXd rho(lags + 1);
  rho(0) = 1.0;
  rho.segment(1, p) = a.partialPivLu().solve(b);
  for (Eigen::Index k = p + 1; k <= lags; ++k) {
    rho(k) = 0.0;
    for (Eigen::Index j = 1; j <= p; ++j)
      rho(k) += phi[static_cast<std::size_t>(j - 1)] * rho(k - j);
  }
  return rho;
}

TEST(AutoregressiveLikelihood, EqualsTheMultivariateNormal) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  const int n = 40;
  for (const std::vector<double>& partial :
       {std::vector<double>{0.7}, {0.8, -0.5}, {-0.3, 0.4, 0.9, -0.2}}) {
    std::vector<double> r(n);
    for (double& value : r) value = normal(generator);
    const Eigen::VectorXd rho = theoretical(ar_coefficients(partial), n);
    Eigen::MatrixXd covariance(n, n);
    const double sigma = 1.7;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) covariance(i, j) = sigma * sigma * rho(std::abs(i - j));
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const Eigen::Map<const Eigen::VectorXd> x(r.data(), n);
    const double expected = -0.5 * n * std::log(2.0 * std::numbers::pi) -
                            factor.matrixL().toDenseMatrix().diagonal().array().log().sum() -
                            0.5 * x.dot(factor.solve(x));
    EXPECT_NEAR(ar_log_likelihood(r, partial, sigma), expected, 1e-9 * std::abs(expected));
  }
}

// ln p = c(π) - N ln σ - ½ Σ e²/σ²: two records differ only in their innovations.
TEST(AutoregressiveLikelihood, EqualsThatOfItsInnovations) {
  std::mt19937_64 generator(6);
  std::normal_distribution<double> normal;
  std::vector<double> a(30), b(30);
  for (double& value : a) value = normal(generator);
  for (double& value : b) value = 2.0 * normal(generator);
  const double sigma = 0.8;
  for (const std::vector<double>& partial : {std::vector<double>{}, {0.7}, {-0.3, 0.4, 0.9}}) {
    const auto squares = [&](const std::vector<double>& r) {
      std::vector<double> e = r;
      ar_innovations(e, partial, e);  // in place
      double sum = 0.0;
      for (const double value : e) sum += value * value;
      return sum;
    };
    EXPECT_NEAR(ar_log_likelihood(a, partial, sigma) - ar_log_likelihood(b, partial, sigma),
                0.5 * (squares(b) - squares(a)) / (sigma * sigma), 1e-9);
  }
}

TEST(AutoregressiveLikelihood, OrderZeroIsWhite) {
  const std::vector<double> r{0.3, -0.2, 0.5};
  EXPECT_NEAR(ar_log_likelihood(r, {}, 0.4), gaussian_log_likelihood(0.38, 3, 0.4), 1e-14);
  EXPECT_EQ(gaussian_log_likelihood(wheeltap::kInfinity, 3, 0.4), -wheeltap::kInfinity);
  EXPECT_EQ(gaussian_log_likelihood(1.0, 3, 0.0), -wheeltap::kInfinity);
  EXPECT_EQ(ar_log_likelihood(r, std::vector<double>{1.0}, 0.4), -wheeltap::kInfinity);
  EXPECT_EQ(ar_log_likelihood(r, {}, -1.0), -wheeltap::kInfinity);
}

// AR(2): φ₂ = π₂, φ₁ = π₁ (1 - π₂).
TEST(AutoregressiveCoefficients, MatchTheSecondOrderFormula) {
  const std::vector<double> phi = ar_coefficients(std::vector<double>{0.6, -0.4});
  EXPECT_NEAR(phi[0], 0.6 * 1.4, 1e-15);
  EXPECT_NEAR(phi[1], -0.4, 1e-15);
  EXPECT_THROW((void)ar_coefficients(std::vector<double>{1.0}), std::invalid_argument);
}

/// n samples of the process with these partial autocorrelations, past its start.
std::vector<double> process(const std::vector<double>& partial, std::size_t n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const std::vector<double> phi = ar_coefficients(partial);
  std::vector<double> x(n + 500, 0.0);
  for (std::size_t t = phi.size(); t < x.size(); ++t) {
    x[t] = normal(generator);
    for (std::size_t j = 0; j < phi.size(); ++j) x[t] += phi[j] * x[t - 1 - j];
  }
  return {x.begin() + 500, x.end()};
}

// Residuals nearly as smooth as a response, for which Yule-Walker misses the second.
TEST(BurgPartialAutocorrelation, RecoversASmoothProcessFromFewSamples) {
  const std::vector<double> x = process({0.98, -0.995}, 400, 8);
  const std::vector<double> burg = burg_partial_autocorrelation(x, 4);
  EXPECT_NEAR(burg[1], -0.995, 0.02);
  EXPECT_LT(std::abs(burg[3]), 5.0 / std::sqrt(400.0));
  EXPECT_EQ(burg_partial_autocorrelation(std::vector<double>(10, 0.0), 3),
            std::vector<double>(3, 0.0));
}

// Schwarz's criterion selects an order that is too high with a probability of about P(χ²₁ > ln N)
// per lag: 1 % at 1000 samples, some 5 % over the first few lags. 9 or more of 40 runs have a
// probability of 1e-4.
TEST(AutoregressiveOrder, RecoversTheProcess) {
  for (const auto& [partial, order] :
       {std::pair(std::vector<double>{}, 0), std::pair(std::vector<double>{0.5}, 1),
        std::pair(std::vector<double>{0.9, -0.8, 0.4}, 3)}) {
    int wrong = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
      const int found = autoregressive_order(process(partial, 1000, seed));
      EXPECT_GE(found, order);
      wrong += found != order ? 1 : 0;
    }
    EXPECT_LE(wrong, 8) << order;
  }
  EXPECT_EQ(autoregressive_order(std::vector<double>(3, 1.0)), 0);
}

// Under whiteness the p-values are uniform: Kolmogorov distance of 400 of them, false alarm rate
// 1e-4.
TEST(LjungBox, IsUniformOnWhiteNoise) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  std::vector<double> p;
  for (int run = 0; run < 400; ++run) {
    std::vector<double> x(500);
    for (double& value : x) value = normal(generator);
    p.push_back(ljung_box(x, 10).p_value);
  }
  std::sort(p.begin(), p.end());
  double distance = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i)
    distance = std::max(distance, std::abs(p[i] - (static_cast<double>(i) + 0.5) / 400.0));
  EXPECT_LT(distance, std::sqrt(-0.5 * std::log(0.5e-4) / 400.0));
}

TEST(LjungBox, RejectsMisuse) {
  const std::vector<double> x(10, 1.0);
  EXPECT_THROW((void)ljung_box(x, 10), std::invalid_argument);
  EXPECT_THROW((void)ljung_box(x, 2, 2), std::invalid_argument);
  EXPECT_EQ(autocorrelation(x, 3), std::vector<double>(3, 0.0));
}

}  // namespace
