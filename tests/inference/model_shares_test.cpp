#include "inference/diagnosis/model_shares.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/inference/made_up_posterior.hpp"

namespace wheeltap::inference {
namespace {

using testing::ElementsAre;
using testing::Pointwise;

// Draws of these models, one list per chain.
Posterior drawn(const std::vector<std::vector<int>>& chains) {
  Posterior posterior;
  posterior.space = std::make_shared<const ModelSpace>(made_up::three());
  posterior.dimension = 1;
  for (const auto& models : chains) {
    Chain chain;
    chain.model.assign(models.begin(), models.end());
    chain.theta.assign(models.size(), 0.0);
    chain.log_prior.assign(models.size(), 0.0);
    chain.log_likelihood.assign(models.size(), 0.0);
    posterior.chains.push_back(std::move(chain));
  }
  return posterior;
}

TEST(ModelShares, AreCountedChainByChain) {
  const ModelShares shares = model_shares(drawn({{0, 0, 1, 0}, {1, 1, 0, 0}}));
  EXPECT_THAT(shares.counts, ElementsAre(ElementsAre(3, 1, 0), ElementsAre(2, 2, 0)));
  EXPECT_THAT(shares.visits, ElementsAre(0.625, 0.375, 0.0));
  EXPECT_THAT(shares.share, Pointwise(testing::DoubleNear(1e-15), shares.visits));
  EXPECT_EQ(shares.error[2], 0.0) << "for a model without draws";
}

// w = (1, 2, 8) and draws 5 : 3 : 0 give P = (5, 6, 0) / 11, for any constant added to all ln w.
TEST(ModelShares, AreWeightedByTheWeightsOfTheModels) {
  for (const double added : {0.0, -800.0, 700.0}) {
    Posterior posterior = drawn({{0, 0, 1, 0}, {1, 1, 0, 0}});
    posterior.log_weight = {added, added + std::log(2.0), added + std::log(8.0)};
    const ModelShares shares = model_shares(posterior);
    EXPECT_NEAR(shares.share[0], 5.0 / 11.0, 1e-12);
    EXPECT_NEAR(shares.share[1], 6.0 / 11.0, 1e-12);
    EXPECT_EQ(shares.share[2], 0.0);
    EXPECT_NEAR(shares.weight[1] / shares.weight[0], 2.0, 1e-12);
    EXPECT_NEAR(0.625 * shares.weight[0] + 0.375 * shares.weight[1], 1.0, 1e-12)
        << "one on average over the draws";
  }
}

// With n independent draws and a model of share s whose draws have weight w instead of 1, P = w s /
// (w s + 1 - s). By the delta method, its standard error is w √(s (1 - s) / n) / (w s + 1 - s)².
TEST(ModelShares, ErrorsMatchIndependentDraws) {
  for (const double w : {1.0, 0.05, 30.0}) {
    Posterior posterior = made_up::run({{0.7, 0.3, 0.0}});
    posterior.log_weight = {0.0, std::log(w), 0.0};
    const ModelShares shares = model_shares(posterior);
    const double n = 4.0 * made_up::kDraws, s = shares.visits[1], norm = w * s + 1.0 - s;
    EXPECT_NEAR(shares.share[1], w * s / norm, 1e-12) << "weight " << w;
    // The estimate of the effective number of 16 000 independent draws has an error of about 10 %.
    EXPECT_NEAR(shares.error[1] / (w * std::sqrt(s * (1.0 - s) / n) / (norm * norm)), 1.0, 0.15)
        << "weight " << w;
    EXPECT_NEAR(shares.error[0] / shares.error[1], 1.0, 0.05)
        << "the errors of two models are equal";
  }
}

TEST(ModelShares, AreEmptyWithoutDraws) {
  const ModelShares shares = model_shares(drawn({{}, {}}));
  EXPECT_THAT(shares.share, ElementsAre(0.0, 0.0, 0.0));
  EXPECT_THAT(shares.error, ElementsAre(0.0, 0.0, 0.0));
}

}  // namespace
}  // namespace wheeltap::inference
