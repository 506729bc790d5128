#include "inference/statistics/hierarchical_posterior.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/constants.hpp"
#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

const std::vector<GroupEstimate> kSchools = {{28.39, 14.9}, {7.94, 10.2}, {-2.75, 16.3},
                                             {6.82, 11.0},  {-0.64, 9.4}, {0.63, 11.4},
                                             {18.01, 10.4}, {12.16, 17.6}};

/// ln p(μ, τ | groups), up to a constant.
double log_joint(const std::vector<GroupEstimate>& groups, const HierarchicalOptions& o,
                 double lambda, double mu, double tau) {
  double sum = -0.5 * std::pow((mu - o.centre_mean) / o.centre_sd, 2) - std::log(lambda + tau);
  for (const GroupEstimate& g : groups) {
    const double v = g.sd * g.sd + tau * tau;
    sum -= 0.5 * (std::log(v) + std::pow(g.mean - mu, 2) / v);
  }
  return sum;
}

// The eight schools (Rubin 1981) by brute force: a fine grid over both μ and τ.
TEST(HierarchicalPosterior, MatchesATwoDimensionalGrid) {
  const HierarchicalOptions options{.centre_mean = 5.0, .centre_sd = 25.0, .largest_scatter = 60.0};
  const HierarchicalPosterior h = hierarchical_posterior(kSchools, options);
  double precision = 0.0;
  for (const GroupEstimate& g : kSchools) precision += 1.0 / (g.sd * g.sd);
  const double lambda = std::sqrt(8.0 / precision);
  EXPECT_NEAR(h.own_error, lambda, 1e-12 * lambda);
  constexpr int kGrid = 1500;
  double all = 0.0, mean = 0.0, below = 0.0, new_below = 0.0, scatter = 0.0;
  for (int i = 0; i < kGrid; ++i) {
    const double tau = 60.0 * (i + 0.5) / kGrid;
    for (int j = 0; j < kGrid; ++j) {
      const double mu = 5.0 + 160.0 * ((j + 0.5) / kGrid - 0.5);
      const double p = std::exp(log_joint(kSchools, options, lambda, mu, tau));
      all += p;
      mean += p * mu;
      scatter += p * tau;
      below += mu < 2.0 ? p : 0.0;
      new_below += p * 0.5 * std::erfc((mu - 2.0) / (M_SQRT2 * tau));
    }
  }
  const double nodes_mean = h.centre.expectation([](double x) { return x; });
  EXPECT_NEAR(nodes_mean, mean / all, 2e-4 * 10.0);
  EXPECT_NEAR(h.centre.cdf(2.0), below / all, 5e-4);  // the grid's cells are 0.1 wide
  EXPECT_NEAR(h.group.cdf(2.0), new_below / all, 1e-4);
  double nodes_scatter = 0.0;
  for (std::size_t i = 0; i < h.scatter.size(); ++i) nodes_scatter += h.weight[i] * h.scatter[i];
  EXPECT_NEAR(nodes_scatter, scatter / all, 2e-4 * 10.0);
  for (const double p : {0.025, 0.5, 0.95}) {
    EXPECT_NEAR(h.estimate.cdf(h.estimate.quantile(p)), p, 1e-10);
  }
}

// If groups scatter by far more than their errors, the interval is Student's: mean ± t s/√n.
TEST(HierarchicalPosterior, IsStudentsTForPreciseGroups) {
  const std::vector<GroupEstimate> groups = {
      {0.11, 1e-7}, {0.14, 1e-7}, {0.08, 1e-7}, {0.10, 1e-7}, {0.17, 1e-7}};
  const HierarchicalPosterior h =
      hierarchical_posterior(groups, {.centre_sd = 1e3, .largest_scatter = 1e4});
  const double mean = 0.12, s = std::sqrt(0.005 / 4.0);
  constexpr double kT = 2.131847;  // quantile for 4 degrees of freedom, 95 %
  EXPECT_NEAR(h.centre.quantile(0.95), mean + kT * s / std::sqrt(5.0), 1e-3 * s);
  EXPECT_NEAR(h.group.quantile(0.05), mean - kT * s * std::sqrt(1.2), 2e-3 * s);
}

// Groups with equal values and decreasing errors: the scatter decreases with them, and the centre's
// interval becomes that of the pooled data.
TEST(HierarchicalPosterior, ScatterOfEqualGroupsDecreasesWithTheirErrors) {
  for (const double sd : {0.1, 0.001}) {
    std::vector<GroupEstimate> groups;
    for (int j = 0; j < 60; ++j) {
      base::Random random(7, 0, static_cast<std::uint64_t>(j), base::Purpose::test);
      groups.push_back({0.3 + sd * random.normal(), sd});
    }
    const HierarchicalPosterior h = hierarchical_posterior(groups);
    const auto scatter_quantile = [&](double p) {
      double sum = 0.0;
      for (std::size_t i = 0; i < h.scatter.size(); ++i)
        if ((sum += h.weight[i]) >= p) return h.scatter[i];
      return h.scatter.back();
    };
    EXPECT_LT(scatter_quantile(0.5), 0.4 * sd);
    EXPECT_LT(scatter_quantile(0.975), sd);
    const double width = h.centre.quantile(0.95) - h.centre.quantile(0.05);
    EXPECT_NEAR(width, 2.0 * 1.645 * sd / std::sqrt(60.0), 0.15 * width);
    EXPECT_GT(birge_ratio(groups).p_value, 1e-3);
  }
}

// Calibration for a true scatter of zero, one and three times the error: the coverage of the 90 %
// intervals for the centre, a new group and a new group's mean. 1000 repetitions each; the
// tolerance is four standard deviations of a binomial, 0.038.
TEST(HierarchicalPosterior, IntervalsHaveNominalCoverage) {
  constexpr int kRepetitions = 1000, kGroups = 6;
  std::uint64_t stream = 0;
  for (const double tau : {0.0, 0.05, 0.15}) {
    int centre = 0, group = 0, estimate = 0;
    for (int r = 0; r < kRepetitions; ++r) {
      base::Random random(11, stream++, 0, base::Purpose::test);
      std::vector<GroupEstimate> groups;
      for (int j = 0; j < kGroups; ++j) {
        const double sd = 0.05 * (0.7 + 0.6 * random.uniform());
        groups.push_back({0.4 + tau * random.normal() + sd * random.normal(), sd});
      }
      const HierarchicalPosterior h =
          hierarchical_posterior(groups, {.centre_sd = 10.0, .largest_scatter = 10.0});
      const auto holds = [](const LineMixture& of, double x) {
        const double below = of.cdf(x);
        return below > 0.05 && below < 0.95 ? 1 : 0;
      };
      const double theta = 0.4 + tau * random.normal();
      centre += holds(h.centre, 0.4);
      group += holds(h.group, theta);
      estimate += holds(h.estimate, theta + 0.05 * random.normal());
    }
    const auto at_least = [&](int held) { return held >= (0.90 - 0.038) * kRepetitions; };
    EXPECT_TRUE(at_least(centre)) << centre << " at " << tau;
    EXPECT_TRUE(at_least(group)) << group << " at " << tau;
    EXPECT_TRUE(at_least(estimate)) << estimate << " at " << tau;
    if (tau > 0.1) {
      // Nor too wide: if scatter dominates, the centre's intervals are Student's.
      EXPECT_LE(centre, (0.90 + 0.045) * kRepetitions);
      EXPECT_LE(estimate, (0.90 + 0.045) * kRepetitions);
    }
  }
}

TEST(HierarchicalPosterior, IgnoresGroupsWithoutInformation) {
  std::vector<GroupEstimate> groups = kSchools;
  const HierarchicalPosterior without =
      hierarchical_posterior(groups, {.centre_sd = 25.0, .largest_scatter = 60.0});
  groups.push_back({1e6, kInfinity});
  const HierarchicalPosterior with =
      hierarchical_posterior(groups, {.centre_sd = 25.0, .largest_scatter = 60.0});
  EXPECT_EQ(with.groups, 8);
  EXPECT_DOUBLE_EQ(with.centre.quantile(0.3), without.centre.quantile(0.3));
  EXPECT_DOUBLE_EQ(birge_ratio(groups).ratio, birge_ratio(kSchools).ratio);
}

TEST(HierarchicalPosterior, RejectsInvalidInput) {
  EXPECT_THROW(static_cast<void>(hierarchical_posterior(std::vector<GroupEstimate>{{0.0, 1.0}})),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(hierarchical_posterior(
                   std::vector<GroupEstimate>{{0.0, 1.0}, {1.0, 0.0}, {1.0, 1.0}})),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(hierarchical_posterior(kSchools, {.largest_scatter = 0.0})),
               std::invalid_argument);
}

// χ² of the eight schools is 4.56 with 7 degrees of freedom (p = 0.71).
TEST(BirgeRatio, MatchesTheEightSchools) {
  const BirgeRatio b = birge_ratio(kSchools);
  double w = 0.0, m = 0.0, q = 0.0;
  for (const GroupEstimate& g : kSchools) w += 1.0 / (g.sd * g.sd), m += g.mean / (g.sd * g.sd);
  for (const GroupEstimate& g : kSchools) q += std::pow((g.mean - m / w) / g.sd, 2);
  EXPECT_NEAR(b.ratio, std::sqrt(q / 7.0), 1e-12);
  EXPECT_GT(b.p_value, 0.6);
  EXPECT_LT(b.p_value, 0.8);
}

}  // namespace
}  // namespace wheeltap::inference
