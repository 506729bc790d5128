#include "base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace wheeltap::base {
namespace {

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

/// Kolmogorov-Smirnov distance times √n of values that should be uniform; exceeds 2.2 with
/// probability 2 exp(-2 · 2.2²) = 1.3e-4.
double kolmogorov_smirnov(std::vector<double> u) {
  std::ranges::sort(u);
  const auto n = static_cast<double>(u.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i)
    worst =
        std::max({worst, static_cast<double>(i + 1) / n - u[i], u[i] - static_cast<double>(i) / n});
  return worst * std::sqrt(n);
}

constexpr double kCritical = 2.2;
constexpr int kDraws = 200000;

TEST(Random, UniformAndNormalHaveTheirDistributions) {
  Random random(1, 0, 0, Purpose::test);
  std::vector<double> uniform, normal, exponential, index;
  for (int i = 0; i < kDraws; ++i) {
    uniform.push_back(random.uniform());
    normal.push_back(normal_cdf(random.normal()));
    exponential.push_back(-std::expm1(-random.exponential()));
    index.push_back((random.index(7) + random.uniform()) / 7.0);
  }
  EXPECT_LT(kolmogorov_smirnov(uniform), kCritical);
  EXPECT_LT(kolmogorov_smirnov(normal), kCritical);
  EXPECT_LT(kolmogorov_smirnov(exponential), kCritical);
  EXPECT_LT(kolmogorov_smirnov(index), kCritical);
}

// Tails, where a piecewise sampler would fail first: counts beyond each threshold are Poisson.
TEST(Random, NormalTailsHaveTheirProbabilities) {
  Random random(2, 0, 0, Purpose::test);
  constexpr int kMany = 4000000;
  const std::vector<double> thresholds = {1.0, 2.0, 3.0, 3.5, 3.7, 4.0, 4.5};
  std::vector<double> above(thresholds.size(), 0.0), below = above;
  for (int i = 0; i < kMany; ++i) {
    const double z = random.normal();
    for (std::size_t t = 0; t < thresholds.size(); ++t) {
      above[t] += z > thresholds[t] ? 1.0 : 0.0;
      below[t] += z < -thresholds[t] ? 1.0 : 0.0;
    }
  }
  for (std::size_t t = 0; t < thresholds.size(); ++t) {
    const double expected = kMany * normal_cdf(-thresholds[t]);
    EXPECT_NEAR(above[t], expected, 4.5 * std::sqrt(expected)) << thresholds[t];
    EXPECT_NEAR(below[t], expected, 4.5 * std::sqrt(expected)) << thresholds[t];
  }
}

TEST(Random, GammaHasItsMoments) {
  for (const double shape : {0.05, 0.5, 1.0, 3.0, 200.0}) {
    Random random(3, 0, 0, Purpose::test);
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double g = random.gamma(shape);
      mean += g / kDraws;
      square += (g - shape) * (g - shape) / kDraws;
    }
    // The variance of a squared deviation is 2 a² + 6 a.
    EXPECT_NEAR(mean, shape, 4.5 * std::sqrt(shape / kDraws)) << shape;
    EXPECT_NEAR(square, shape, 4.5 * std::sqrt((2.0 * shape * shape + 6.0 * shape) / kDraws))
        << shape;
  }
}

TEST(Random, DrawsAreIndependent) {
  // Pairs in sequence, and the two members of a Box-Muller pair's squares: correlations are N(0,
  // 1/n).
  Random random(4, 0, 0, Purpose::test);
  double sequence = 0.0, squares = 0.0, previous = random.normal();
  for (int i = 0; i < kDraws; ++i) {
    const double z = random.normal();
    sequence += previous * z;
    squares += (previous * previous - 1.0) * (z * z - 1.0);
    previous = z;
  }
  EXPECT_LT(std::fabs(sequence), 4.0 * std::sqrt(kDraws));
  EXPECT_LT(std::fabs(squares), 4.0 * 2.0 * std::sqrt(kDraws));
}

TEST(Random, StreamsDependOnTheirKeyAlone) {
  Random a(1, 2, 3, Purpose::sampling), b(1, 2, 3, Purpose::sampling);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.bits(), b.bits());
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (std::uint64_t chain = 0; chain < 4; ++chain)
      for (std::uint64_t iteration = 0; iteration < 4; ++iteration)
        for (const Purpose purpose : {Purpose::start, Purpose::sampling, Purpose::swap})
          first.insert(Random(seed, chain, iteration, purpose).bits());
  EXPECT_EQ(first.size(), 4U * 4U * 4U * 3U);
  // One draw from each of many streams is as uniform as many draws from one.
  std::vector<double> across;
  for (std::uint64_t i = 0; i < kDraws; ++i)
    across.push_back(Random(1, 0, i, Purpose::sampling).uniform());
  EXPECT_LT(kolmogorov_smirnov(across), kCritical);
}

}  // namespace
}  // namespace wheeltap::base
