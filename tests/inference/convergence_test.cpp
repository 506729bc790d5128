#include "inference/diagnosis/convergence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

// Independent draws of two models without parameters; the second has a different probability in
// each chain (the last value repeats).
Posterior made_up(int draws, const std::vector<double>& probabilities, double shift = 0.0) {
  Posterior posterior;
  posterior.space = std::make_shared<const ModelSpace>(
      ModelSpace::of_models({{"a", Normal{0.0, 1.0}}}, {{"one", 1.0, {}}, {"two", 1.0, {"a"}}}));
  posterior.dimension = 1;
  posterior.draws = draws;
  posterior.likelihood_evaluations = 1;
  for (std::size_t c = 0; c < 4; ++c) {
    base::Random random(7, c, 0, base::Purpose::test);
    const double p = probabilities[std::min(c, probabilities.size() - 1)];
    Chain chain;
    for (int i = 0; i < draws; ++i) {
      chain.model.push_back(random.uniform() < p ? 1 : 0);
      chain.theta.push_back(random.normal());
      chain.log_prior.push_back(0.0);
      chain.log_likelihood.push_back(random.normal() + (c == 3 ? shift : 0.0));
    }
    posterior.chains.push_back(std::move(chain));
  }
  return posterior;
}

// p (1 - p) / n = 0.004² needs n = 15 600 effective draws at p = ½.
TEST(Convergence, StopsARunWhenItsProbabilitiesAreKnownToFourInAThousand) {
  EXPECT_FALSE(may_stop(made_up(2500, {0.5}), false));
  EXPECT_TRUE(may_stop(made_up(6000, {0.5}), false));
  EXPECT_FALSE(may_stop(made_up(6000, {0.5}), true));  // 0.001 for balanced draws
  EXPECT_TRUE(may_stop(made_up(2500, {0.0005}), false));
}

TEST(Convergence, ContinuesARunWhileTheVerdictNamesAReason) {
  Posterior posterior = made_up(6000, {0.5});
  posterior.tempered_draws = true;
  posterior.ladder_round_trips = kLimits.round_trips - 1;
  EXPECT_FALSE(may_stop(posterior, false));
  posterior.ladder_round_trips = kLimits.round_trips;
  EXPECT_TRUE(may_stop(posterior, false));
}

TEST(Convergence, DetectsChainsThatDisagreeOnModelsOrThePosterior) {
  EXPECT_TRUE(chains_agree(made_up(2000, {0.5})));
  EXPECT_FALSE(chains_agree(made_up(2000, {0.5, 0.9})));
  EXPECT_FALSE(chains_agree(made_up(2000, {0.5}, 2.0)));
}

}  // namespace
}  // namespace wheeltap::inference
