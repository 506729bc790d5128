#include "inference/evidence/metropolis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "inference/statistics/diagnostics.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

ChainsOf coordinate(const std::vector<Eigen::MatrixXd>& chains, Eigen::Index j) {
  ChainsOf result;
  for (const Eigen::MatrixXd& c : chains) result.emplace_back(c.col(j).begin(), c.col(j).end());
  return result;
}

double mean_of_chains(const ChainsOf& chains) {
  double sum = 0.0, n = 0.0;
  for (const auto& chain : chains)
    for (const double x : chain) {
      sum += x;
      n += 1.0;
    }
  return sum / n;
}

// Conjugate: μ | ȳ = 0.5, n = 20 under N(0, 1) is N(10/21, 1/21).
TEST(Metropolis, NestedMeansPosterior) {
  const ModelSamples samples = metropolis(nested_means(), 1, {.seed = 1});
  const ChainsOf mu = coordinate(samples.x, 0);
  EXPECT_NEAR(mean_of_chains(mu), 10.0 / 21.0, 4.5 * mcse_mean(mu));
  ChainsOf squares = mu;
  for (auto& chain : squares)
    for (double& x : chain) x = (x - 10.0 / 21.0) * (x - 10.0 / 21.0);
  EXPECT_NEAR(mean_of_chains(squares), 1.0 / 21.0, 4.5 * mcse_mean(squares));
  EXPECT_LT(mcse_mean(squares), 0.002);
  EXPECT_LT(samples.rhat, 1.02);
  EXPECT_NEAR(samples.acceptance, 0.44, 0.1);
  EXPECT_EQ(samples.likelihood_evaluations, 4 * (50 + 3000 + 5000));
  // Stored values equal those of a new evaluation.
  const Problem problem = nested_means();
  ModelPosterior posterior(problem, 1);
  for (Eigen::Index i = 0; i < 100; ++i) {
    const double z = samples.z[2](i, 0);
    EXPECT_EQ(posterior({&z, 1}).log_posterior(),
              samples.log_posterior[2][static_cast<std::size_t>(i)]);
    EXPECT_EQ(posterior.x()[0], samples.x[2](i, 0));
  }
}

TEST(Metropolis, FindsTheScaleOfANarrowRidge) {
  const ModelSamples samples = metropolis(linear_gaussian(5).problem, 0, {.seed = 1});
  EXPECT_LT(samples.rhat, 1.1);
  EXPECT_NEAR(samples.acceptance, 0.234, 0.08);
}

TEST(Metropolis, StaysInOneModeUnlessThePilotCoversBoth) {
  const Known known = two_narrow_modes(2);
  const ModelSamples alone = metropolis(known.problem, 0, {.seed = 1, .chains = 8});
  EXPECT_GT(alone.rhat, 1.2);
  ASSERT_FALSE(alone.warnings.empty());
  base::Random random(1, 0, 0, base::Purpose::test);
  Eigen::MatrixXd modes(400, 2);
  for (int i = 0; i < 400; ++i)
    for (int j = 0; j < 2; ++j) modes(i, j) = (i % 2 == 0 ? 1.0 : -1.0) + 0.05 * random.normal();
  const NormalMixture pilot = NormalMixture::fit(modes, random);
  const ModelSamples both = metropolis(known.problem, 0, pilot, {.seed = 1});
  EXPECT_LT(both.rhat, 1.01);
  ChainsOf right = coordinate(both.z, 0);
  for (auto& chain : right)
    for (double& z : chain) z = z > 0.0 ? 1.0 : 0.0;
  EXPECT_NEAR(mean_of_chains(right), 0.75, 4.5 * mcse_mean(right));
}

TEST(Metropolis, ComponentsStayInOrder) {
  const ModelSamples samples = metropolis(exchangeable(3).problem, 0, {.seed = 1});
  for (const Eigen::MatrixXd& z : samples.z)
    for (Eigen::Index i = 0; i < z.rows(); ++i) {
      ASSERT_LE(z(i, 0), z(i, 1));
      ASSERT_LE(z(i, 1), z(i, 2));
    }
}

TEST(Metropolis, RejectsInvalidOptions) {
  EXPECT_THROW((void)metropolis(never(), 0, {}), LikelihoodError);
  EXPECT_THROW((void)metropolis(nested_means(), 0, {}), std::invalid_argument);
  EXPECT_THROW((void)metropolis(nested_means(), 1, {.draws = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::inference
