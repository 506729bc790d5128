#include "inference/evidence/importance_sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "inference/evidence/tmcmc.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

NormalMixture pilot(const Problem& problem, double nu) {
  base::Random random(1, 0, 0, base::Purpose::test);
  NormalMixture::FitOptions options;
  options.degrees_of_freedom = nu;
  return NormalMixture::fit(tmcmc(problem, 0, {.replicates = 4, .samples = 300}).z, options,
                            random);
}

TEST(ImportanceSampling, AgreesWithClosedForms) {
  const std::vector<Known> all = {linear_gaussian(1), linear_gaussian(4), two_narrow_modes(2),
                                  exchangeable(2), corner()};
  for (const double nu : {std::numeric_limits<double>::infinity(), 10.0})
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ImportanceSampling r =
          importance_sampling(all[i].problem, 0, pilot(all[i].problem, nu), {.seed = 1});
      EXPECT_NEAR(r.evidence.log_evidence, all[i].log_evidence, 4.5 * r.evidence.standard_error)
          << "problem " << i << ", nu " << nu;
      EXPECT_LT(r.evidence.standard_error, 0.02) << "problem " << i;
      EXPECT_GT(r.effective_draws, 2000.0) << "problem " << i;
      EXPECT_TRUE(r.evidence.warnings.empty()) << "problem " << i;
    }
}

TEST(ImportanceSampling, StandardErrorCovers) {
  const Known known = linear_gaussian(3);
  const NormalMixture q = pilot(known.problem, 10.0);
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Evidence e =
        importance_sampling(known.problem, 0, q, {.seed = seed, .draws = 1000}).evidence;
    inside += std::fabs(e.log_evidence - known.log_evidence) < 1.96 * e.standard_error ? 1 : 0;
  }
  // Binomial(100, 0.95): below 86 with a probability of 3e-4.
  EXPECT_GE(inside, 86);
}

TEST(ImportanceSampling, WarnsOfATooNarrowProposal) {
  const Known known = linear_gaussian(3);
  const NormalMixture good = pilot(known.problem, 10.0);
  std::vector<NormalMixture::Component> narrow;
  for (int k = 0; k + 1 < good.size(); ++k)  // without the defensive component
    narrow.push_back({good[k].weight, good[k].mean, 0.3 * good[k].factor});
  const ImportanceSampling r = importance_sampling(known.problem, 0, NormalMixture(narrow), {});
  EXPECT_GT(r.pareto_k, 0.7);
  EXPECT_FALSE(r.evidence.warnings.empty());
}

// Weights u^-k with u uniform have exactly the Pareto shape k.
TEST(ParetoShape, RecoversTheTailIndex) {
  for (const double k : {0.2, 0.5, 1.0}) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      base::Random random(seed, 0, 0, base::Purpose::test);
      std::vector<double> log_weights;
      for (int i = 0; i < 20000; ++i) log_weights.push_back(-k * std::log(random.uniform()));
      sum += pareto_shape(log_weights) / 10.0;
    }
    // sd (1 + k)/√(3√n · 10) is 0.02 to 0.03, and the shrinkage towards ½ has 10 / 434 of the
    // weight.
    EXPECT_NEAR(sum, k, 0.1) << k;
  }
}

// The mean of n weights u^-1 grows as ln n; of u^-0.2 it has converged.
TEST(ParetoTail, PredictsTheEvidenceOfALongerSample) {
  constexpr int n = 20000;
  for (const double k : {0.2, 1.0}) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      base::Random random(seed, 0, 0, base::Purpose::test);
      std::vector<double> log_weights;
      for (int i = 0; i < n; ++i) log_weights.push_back(-k * std::log(random.uniform()));
      sum += pareto_tail(log_weights).log_excess / 10.0;
    }
    if (k < 0.5)
      EXPECT_LT(sum, 0.01);
    else
      EXPECT_NEAR(sum, std::log(std::log(100.0 * n) / std::log(1.0 * n)), 0.15);
  }
  EXPECT_EQ(pareto_tail(std::vector<double>(100, 0.0)).log_excess, 0.0);
}

TEST(ImportanceSampling, RejectsInvalidOptions) {
  const Known known = linear_gaussian(2);
  EXPECT_THROW((void)importance_sampling(known.problem, 0, NormalMixture::standard(3), {}),
               std::invalid_argument);
  EXPECT_THROW(
      (void)importance_sampling(known.problem, 0, NormalMixture::standard(2), {.draws = 5}),
      std::invalid_argument);
  EXPECT_THROW((void)importance_sampling(never(), 0, NormalMixture::standard(1), {}),
               LikelihoodError);
}

}  // namespace
}  // namespace wheeltap::inference
