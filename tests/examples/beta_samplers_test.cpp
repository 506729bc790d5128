#include "examples/beta_samplers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::examples {
namespace {

using base::Purpose;

constexpr int kDraws = 40000;

base::Random stream(std::uint64_t seed) {
  return {seed, 0, 0, base::Purpose::test};
}

double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v;
  return sum / static_cast<double>(x.size());
}

// Moments to third order, each within 4.5 of its own Monte Carlo standard errors, and the
// distribution function at nine points: 12 checks of a false-alarm rate of 7e-6 each.
void expect_beta(const std::vector<double>& draws, const std::string& who) {
  const double exact[] = {0.4, 0.2, 4.0 / 35.0};
  std::vector<double> power(draws.size(), 1.0);
  for (const double moment : exact) {
    for (std::size_t i = 0; i < draws.size(); ++i) power[i] *= draws[i];
    const double error = inference::mcse_mean({power});
    EXPECT_NEAR(mean(power), moment, 4.5 * error) << who;
    EXPECT_LT(error, 0.01) << who;
  }
  for (double x = 0.1; x < 0.95; x += 0.1) {
    std::vector<double> below;
    for (const double mu : draws) below.push_back(mu <= x ? 1.0 : 0.0);
    const double cdf = x * x * (6.0 - 8.0 * x + 3.0 * x * x);
    EXPECT_NEAR(mean(below), cdf, 4.5 * inference::mcse_mean({below})) << who << " at " << x;
  }
}

TEST(BetaSamplers, DrawBeta) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    base::Random random = stream(seed);
    expect_beta(rejection(kDraws, random), "rejection");
    expect_beta(gibbs(kDraws, random), "gibbs");
    expect_beta(metropolis_hastings(beta_density, 0.5, 0.4, kDraws, random), "metropolis-hastings");
    expect_beta(slice(beta_density, 0.5, 0.3, kDraws, random), "slice");
  }
}

TEST(BetaSamplers, ImportanceSamplingGivesTheExpectation) {
  // Exact: 4/35 + 1/5 + 4 · 2/5 + 1/5. The standard errors' own honesty: 200 seeds, χ² within 4 sd.
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    base::Random random = stream(seed);
    const WeightedMean y = importance(polynomial, 1000, random);
    const double z = (y.mean - (2.0 + 4.0 / 35.0)) / y.standard_error;
    squares += z * z / 200.0;
    EXPECT_GT(y.effective_draws, 800.0);
  }
  EXPECT_NEAR(squares, 1.0, 4.0 * std::sqrt(2.0 / 200.0));
}

TEST(BetaSamplers, TheEnvelopeEnvelops) {
  const double j = envelope_factor();
  double closest = 2.0;
  for (double mu = 0.0; mu <= 1.0; mu += 1.23e-5) {
    const double margin = j * proposal_density(mu) - beta_density(mu);
    EXPECT_GE(margin, 0.0) << mu;
    closest = std::min(closest, margin);
  }
  EXPECT_LT(closest, 1e-5);
  EXPECT_GT(j, 1.0);
}

// The control: a walk that forgets to repeat its state when refused does not sample Beta(2, 3).
TEST(BetaSamplers, DroppingRefusedStatesWouldBeNoticed) {
  base::Random random = stream(1);
  const auto chain = metropolis_hastings(beta_density, 0.5, 1.0, kDraws, random);
  std::vector<double> moved;
  for (std::size_t i = 1; i < chain.size(); ++i)
    if (chain[i] != chain[i - 1]) moved.push_back(chain[i]);
  std::vector<double> squares;
  for (const double mu : moved) squares.push_back(mu * mu);
  EXPECT_GT(std::fabs(mean(squares) - 0.2), 4.5 * inference::mcse_mean({squares}));
}

}  // namespace
}  // namespace wheeltap::examples
