#include "inference/statistics/diagnostics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

/// x_t = rho x_{t-1} + √(1 - rho²) e_t, stationary from the start: IACT (1 + rho) / (1 - rho).
ChainsOf autoregressive(double rho, int chains, int draws, std::uint64_t seed) {
  ChainsOf result(static_cast<std::size_t>(chains));
  for (int c = 0; c < chains; ++c) {
    base::Random random(seed, static_cast<std::uint64_t>(c), 0, base::Purpose::test);
    double x = random.normal();
    for (int i = 0; i < draws; ++i) {
      result[static_cast<std::size_t>(c)].push_back(x);
      x = rho * x + std::sqrt(1.0 - rho * rho) * random.normal();
    }
  }
  return result;
}

// An independent implementation, written from the paper without shortcuts: it sorts by counting,
// correlates by the double sum, and truncates a stored sequence.
namespace naive {

ChainsOf halves(const ChainsOf& draws) {
  ChainsOf result;
  for (const auto& chain : draws) {
    const std::size_t half = chain.size() / 2;
    result.emplace_back(chain.begin(), chain.begin() + static_cast<long>(half));
    result.emplace_back(chain.end() - static_cast<long>(half), chain.end());
  }
  return result;
}

std::vector<double> pooled(const ChainsOf& draws) {
  std::vector<double> all;
  for (const auto& chain : draws) all.insert(all.end(), chain.begin(), chain.end());
  return all;
}

double quantile(std::vector<double> all, double p) {
  std::ranges::sort(all);
  const double h = p * static_cast<double>(all.size() - 1);
  const auto i = static_cast<std::size_t>(h);
  if (i + 1 == all.size()) return all[i];
  return all[i] + (h - static_cast<double>(i)) * (all[i + 1] - all[i]);
}

ChainsOf scores(const ChainsOf& draws) {
  const std::vector<double> all = pooled(draws);
  ChainsOf result = draws;
  for (auto& chain : result)
    for (double& x : chain) {
      const auto below = std::ranges::count_if(all, [&](double y) { return y < x; });
      const auto equal = std::ranges::count(all, x);
      const double rank = static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1);
      x = normal_quantile((rank - 0.375) / (static_cast<double>(all.size()) + 0.25));
    }
  return result;
}

double mean_of(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

double variance(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += (v - mean_of(x)) * (v - mean_of(x));
  return sum / static_cast<double>(x.size() - 1);
}

double ess(const ChainsOf& sequences) {
  const std::size_t n = sequences.front().size();
  std::vector<double> means, within;
  for (const auto& x : sequences) {
    means.push_back(mean_of(x));
    within.push_back(variance(x));
  }
  const double w = mean_of(within);
  const double total = w * static_cast<double>(n - 1) / static_cast<double>(n) + variance(means);
  std::vector<double> rho = {1.0};
  for (std::size_t t = 1; t < n; ++t) {
    double c = 0.0;
    for (std::size_t s = 0; s < sequences.size(); ++s)
      for (std::size_t i = 0; i + t < n; ++i)
        c += (sequences[s][i] - means[s]) * (sequences[s][i + t] - means[s]);
    // Geyer's autocovariance divides by n; W by n - 1.
    c /= static_cast<double>(n - 1) * static_cast<double>(sequences.size());
    rho.push_back(1.0 - (w - c) / total);
  }
  std::vector<double> pairs;
  std::size_t t = 0;
  for (; t + 1 < n && rho[t] + rho[t + 1] > 0.0; t += 2) pairs.push_back(rho[t] + rho[t + 1]);
  for (std::size_t i = 1; i < pairs.size(); ++i) pairs[i] = std::min(pairs[i], pairs[i - 1]);
  double tau = -1.0;
  for (const double p : pairs) tau += 2.0 * p;
  if (t + 1 < n) tau += std::max(0.0, rho[t]);
  const auto draws = static_cast<double>(n * sequences.size());
  return std::min(draws / tau > 0.0 ? draws / tau : kInfinity, draws * std::log10(draws));
}

double rhat(const ChainsOf& sequences) {
  const auto n = static_cast<double>(sequences.front().size());
  std::vector<double> means, within;
  for (const auto& x : sequences) {
    means.push_back(mean_of(x));
    within.push_back(variance(x));
  }
  return std::sqrt((mean_of(within) * (n - 1.0) / n + variance(means)) / mean_of(within));
}

Convergence all(const ChainsOf& draws) {
  const ChainsOf split = halves(draws);
  ChainsOf folded = split;
  const double median = quantile(pooled(split), 0.5);
  for (auto& chain : folded)
    for (double& x : chain) x = std::fabs(x - median);
  Convergence result{};
  result.rhat = std::max(rhat(scores(split)), rhat(scores(folded)));
  result.ess_bulk = ess(scores(split));
  result.ess_mean = ess(split);
  result.ess_tail = kInfinity;
  for (const double p : {0.05, 0.95}) {
    const double cut = quantile(pooled(split), p);
    ChainsOf indicator = split;
    for (auto& chain : indicator)
      for (double& x : chain) x = x <= cut ? 1.0 : 0.0;
    result.ess_tail = std::min(result.ess_tail, ess(indicator));
  }
  result.mcse_mean = std::sqrt(variance(pooled(split)) / result.ess_mean);
  return result;
}

}  // namespace naive

void expect_same_verdict(const ChainsOf& draws, const char* what) {
  const Convergence ours = convergence(draws), reference = naive::all(draws);
  EXPECT_NEAR(ours.rhat / reference.rhat, 1.0, 1e-10) << what;
  EXPECT_NEAR(ours.ess_bulk / reference.ess_bulk, 1.0, 1e-9) << what;
  EXPECT_NEAR(ours.ess_tail / reference.ess_tail, 1.0, 1e-9) << what;
  EXPECT_NEAR(ours.ess_mean / reference.ess_mean, 1.0, 1e-9) << what;
  EXPECT_NEAR(ours.mcse_mean / reference.mcse_mean, 1.0, 1e-9) << what;
  EXPECT_EQ(ours.rhat, rhat(draws));
  EXPECT_EQ(ours.ess_bulk, ess_bulk(draws));
  EXPECT_EQ(ours.ess_tail, ess_tail(draws));
  EXPECT_EQ(ours.ess_mean, ess_mean(draws));
  EXPECT_EQ(ours.mcse_mean, mcse_mean(draws));
}

TEST(Diagnostics, AgreeWithAnIndependentImplementation) {
  expect_same_verdict(autoregressive(0.0, 4, 250, 1), "independent");
  expect_same_verdict(autoregressive(0.9, 4, 301, 2), "correlated, odd length");
  expect_same_verdict(autoregressive(0.995, 2, 600, 3),
                      "hardly mixing: correlations beyond the direct lags");
  expect_same_verdict(autoregressive(-0.7, 3, 200, 4), "antithetic");
  expect_same_verdict(autoregressive(0.5, 1, 100, 5), "one chain");
  ChainsOf tied = autoregressive(0.8, 4, 200, 6);
  for (auto& chain : tied)
    for (double& x : chain) x = std::round(x);
  expect_same_verdict(tied, "many ties");
  ChainsOf shifted = autoregressive(0.3, 4, 200, 7);
  for (double& x : shifted[2]) x += 2.0;
  expect_same_verdict(shifted, "one chain elsewhere");
  ChainsOf wide = autoregressive(0.3, 4, 200, 8);
  for (double& x : wide[1]) x *= 5.0;
  expect_same_verdict(wide, "one chain wider");
}

// ESS of an AR(1) chain is N (1 - rho) / (1 + rho). The estimate of an integrated autocorrelation
// time tau from N draws with a window of about 5 tau has a relative sd of about √(2 · 5 tau / N)
// (Sokal 1997); the tolerance is four of these.
TEST(Diagnostics, MatchTheEffectiveSizeOfAutoregressiveChains) {
  for (const double rho : {0.0, 0.5, 0.9, 0.98}) {
    const double tau = (1.0 + rho) / (1.0 - rho), draws = 4.0 * 20000.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const ChainsOf chains = autoregressive(rho, 4, 20000, seed);
      const double tolerance = 4.0 * std::sqrt(10.0 * tau / draws);
      EXPECT_NEAR(draws / ess_mean(chains) / tau, 1.0, tolerance) << rho;
      EXPECT_NEAR(ess_bulk(chains) * tau / draws, 1.0, tolerance) << rho;
      EXPECT_LT(rhat(chains), 1.01);
    }
  }
}

TEST(Diagnostics, StandardErrorOfTheMeanIsCalibrated) {
  // Means of 300 replicates, divided by their reported errors, have variance 1: χ²/300 within 4 sd.
  constexpr int kReplicates = 300;
  double sum = 0.0;
  for (int r = 0; r < kReplicates; ++r) {
    const ChainsOf chains = autoregressive(0.8, 4, 1000, static_cast<std::uint64_t>(100 + r));
    const double z = naive::mean_of(naive::pooled(chains)) / mcse_mean(chains);
    sum += z * z;
  }
  EXPECT_NEAR(sum / kReplicates, 1.0, 4.0 * std::sqrt(2.0 / kReplicates));
}

TEST(Diagnostics, StandardErrorOfTheSpreadIsCalibrated) {
  // The correlation of AR(1) draws does not bias their sd by more than a hundredth of its error.
  constexpr int kReplicates = 300;
  double sum = 0.0, true_sd = 0.0;
  std::vector<double> sds, errors;
  for (int r = 0; r < kReplicates; ++r) {
    const ChainsOf chains = autoregressive(0.8, 4, 1000, static_cast<std::uint64_t>(500 + r));
    sds.push_back(std::sqrt(naive::variance(naive::pooled(chains))));
    errors.push_back(mcse_sd(chains));
    true_sd += sds.back() / kReplicates;
  }
  for (std::size_t r = 0; r < sds.size(); ++r) sum += std::pow((sds[r] - true_sd) / errors[r], 2.0);
  EXPECT_NEAR(sum / kReplicates, 1.0, 4.0 * std::sqrt(2.0 / kReplicates));
}

// One visit of 40 draws in 4000 to a point 10 standard deviations away determines the sd.
TEST(Diagnostics, RareDrawsMakeTheSpreadUncertain) {
  ChainsOf chains = autoregressive(0.0, 4, 1000, 9);
  const double before = mcse_sd(chains) / std::sqrt(naive::variance(naive::pooled(chains)));
  for (std::size_t i = 300; i < 340; ++i) chains[1][i] += 10.0;
  const double after = mcse_sd(chains) / std::sqrt(naive::variance(naive::pooled(chains)));
  EXPECT_LT(before, 0.02);
  EXPECT_GT(after, 0.15);
}

TEST(Diagnostics, AntitheticChainsAreCapped) {
  ChainsOf alternating(4, std::vector<double>(1000));
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t i = 0; i < 1000; ++i) alternating[c][i] = i % 2 == 0 ? 1.0 : -1.0;
  EXPECT_NEAR(ess_mean(alternating), 4000.0 * std::log10(4000.0), 1e-6);
  EXPECT_GT(ess_mean(autoregressive(-0.5, 4, 2000, 1)), 8000.0 * 2.0);
}

TEST(Diagnostics, DetectChainsThatDisagree) {
  ChainsOf shifted = autoregressive(0.0, 4, 1000, 1);
  for (double& x : shifted[0]) x += 1.0;
  EXPECT_GT(rhat(shifted), 1.05);
  // Equal means and different spreads show only in the folded draws.
  ChainsOf wide = autoregressive(0.0, 4, 1000, 2);
  for (double& x : wide[0]) x *= 3.0;
  EXPECT_GT(rhat(wide), 1.05);
  // Splitting the chains shows a trend.
  ChainsOf trend = autoregressive(0.0, 4, 1000, 3);
  for (auto& chain : trend)
    for (std::size_t i = 0; i < 1000; ++i) chain[i] += 0.003 * static_cast<double>(i);
  EXPECT_GT(rhat(trend), 1.05);
}

TEST(Diagnostics, DegenerateInput) {
  const ChainsOf constant(3, std::vector<double>(50, 0.1));
  EXPECT_EQ(rhat(constant), 1.0);
  EXPECT_EQ(ess_bulk(constant), 150.0);
  EXPECT_EQ(ess_mean(constant), 150.0);
  EXPECT_EQ(mcse_mean(constant), 0.0);
  EXPECT_EQ(mcse_sd(constant), 0.0);
  ChainsOf stuck = constant;
  stuck[1].assign(50, 2.0);
  EXPECT_EQ(rhat(stuck), kInfinity);
  EXPECT_LT(ess_mean(stuck), 10.0);
  EXPECT_TRUE(std::isnan(rhat({{1.0, 2.0, 3.0}})));
  ChainsOf broken = autoregressive(0.0, 2, 100, 1);
  broken[1][7] = kNaN;
  EXPECT_TRUE(std::isnan(rhat(broken)));
  EXPECT_TRUE(std::isnan(ess_bulk(broken)));
  EXPECT_TRUE(std::isnan(mcse_mean(broken)));
  // Ranks admit an infinite draw; the mean does not.
  broken[1][7] = -kInfinity;
  EXPECT_TRUE(std::isfinite(rhat(broken)));
  EXPECT_TRUE(std::isnan(ess_mean(broken)));
  EXPECT_THROW((void)rhat({}), std::invalid_argument);
  EXPECT_THROW((void)rhat({{1.0, 2.0}, {1.0}}), std::invalid_argument);
}

/// A two-state chain that leaves 0 with probability a and 1 with probability b: π₁ = a / (a + b),
/// and its indicator has IACT (2 - a - b) / (a + b).
std::vector<int> two_state(double a, double b, int draws, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  std::vector<int> chain;
  int state = random.uniform() < a / (a + b) ? 1 : 0;
  for (int i = 0; i < draws; ++i) {
    chain.push_back(state);
    if (random.uniform() < (state == 0 ? a : b)) state = 1 - state;
  }
  return chain;
}

TEST(ModelProbabilities, UncertaintyOfATwoStateChainIsItsMonteCarloError) {
  const double a = 0.02, b = 0.05, pi = a / (a + b), tau = (2.0 - a - b) / (a + b);
  constexpr int kDraws = 5000, kReplicates = 100;
  double squares = 0.0, size = 0.0;
  for (int r = 0; r < kReplicates; ++r) {
    const std::vector<std::vector<int>> chains = {
        two_state(a, b, kDraws, static_cast<std::uint64_t>(2 * r)),
        two_state(a, b, kDraws, static_cast<std::uint64_t>(2 * r + 1))};
    const ModelProbabilities p = stationary_model_probabilities(chains, 2, 1, 500);
    EXPECT_NEAR(p.mean[0] + p.mean[1], 1.0, 1e-12);
    const double z = (p.mean[1] - pi) / p.sd[1];
    squares += z * z / kReplicates;
    size += p.effective_draws / kReplicates;
  }
  EXPECT_NEAR(squares, 1.0, 4.0 * std::sqrt(2.0 / kReplicates));
  // The mean size over 100 replicates has an error of a few per cent, including skewness.
  EXPECT_NEAR(size / (2.0 * kDraws / tau), 1.0, 0.1);
}

TEST(ModelProbabilities, IndependentDrawsCountInFull) {
  base::Random random(3, 0, 0, base::Purpose::test);
  std::vector<int> chain;
  for (int i = 0; i < 4000; ++i) chain.push_back(random.index(4));
  const ModelProbabilities p = stationary_model_probabilities({chain}, 4, 1, 4000);
  // A variance from 4000 draws has a relative sd of √(2/4000) = 2.2 %, and here three are pooled.
  EXPECT_NEAR(p.effective_draws / 4000.0, 1.0, 0.08);
  EXPECT_EQ(p.transitions.sum(), 3999.0);
}

TEST(ModelProbabilities, OmitModelsNeverVisited) {
  const ModelProbabilities one = stationary_model_probabilities({{2, 2, 2}, {2, 2}}, 4, 1);
  EXPECT_EQ(one.mean, (std::vector<double>{0.0, 0.0, 1.0, 0.0}));
  EXPECT_EQ(one.sd[2], 0.0);
  EXPECT_EQ(one.effective_draws, kInfinity);
  EXPECT_EQ(one.transitions(2, 2), 3.0);
  // Two chains in different models: their proportions are unknown.
  const ModelProbabilities apart =
      stationary_model_probabilities({std::vector<int>(1000, 0), std::vector<int>(1000, 1)}, 2, 1);
  EXPECT_GT(apart.sd[0], 0.2);
  EXPECT_LT(apart.effective_draws, 5.0);
  EXPECT_THROW((void)stationary_model_probabilities({{0, 3}}, 3, 1), std::invalid_argument);
}

TEST(RoundTrips, CountsBothDirections) {
  EXPECT_EQ(round_trips({{0, 1, 2, 1, 0}}, 0, 2), 1);
  EXPECT_EQ(round_trips({{0, 1, 0, 1, 0}}, 0, 2), 0);
  EXPECT_EQ(round_trips({{1, 2, 0, 2, 0, 2}}, 0, 2), 2);
  // Each is half a round trip of a separate chain.
  EXPECT_EQ(round_trips({{0, 2}, {2, 0}}, 0, 2), 0);
  EXPECT_EQ(round_trips({{0, 0, 0}}, 0, 0), 0);
}

}  // namespace
}  // namespace wheeltap::inference
