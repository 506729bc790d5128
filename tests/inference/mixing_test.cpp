#include "inference/diagnosis/mixing.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "inference/diagnosis/convergence.hpp"
#include "tests/inference/made_up_posterior.hpp"

namespace wheeltap::inference {
namespace {

using testing::ElementsAre;
using testing::Pair;

Mixing mixed(const Posterior& posterior, const std::vector<Watched>& watched = {}) {
  return mixing(posterior, model_shares(posterior), watched);
}

// Normal draws; each chain is shifted by `shift` relative to the one before.
ChainsOf quantity(double shift) {
  ChainsOf out(4);
  for (std::uint64_t c = 0; c < 4; ++c) {
    base::Random random(41, c, 0, base::Purpose::test);
    for (int i = 0; i < made_up::kDraws; ++i) {
      out[c].push_back(random.normal() + shift * static_cast<double>(c));
    }
  }
  return out;
}

TEST(Mixing, IndependentDrawsCountInFull) {
  const Mixing found = mixed(made_up::run({{0.6, 0.3, 0.1}}));
  EXPECT_THAT(found.rhats,
              ElementsAre(Pair("log posterior", testing::_), Pair("P(one)", testing::_),
                          Pair("P(two)", testing::_), Pair("P(none)", testing::_)));
  EXPECT_LT(found.rhat_max, kLimits.rhat);
  EXPECT_FALSE(found.too_few);
  const double draws = 4.0 * made_up::kDraws;
  EXPECT_NEAR(found.ess_model / draws, 1.0, 0.2);
  EXPECT_NEAR(found.ess_log_posterior / draws, 1.0, 0.2);
  EXPECT_EQ(found.effective(4), std::min(found.ess_model, found.ess_log_posterior) / 4.0);
}

TEST(Mixing, IgnoresRarelyDrawnModels) {
  // 0.0004 and 0.9996: below 0.1 % and above 99.9 %.
  const Mixing found = mixed(made_up::run({{0.9996, 0.0004, 0.0}}));
  EXPECT_THAT(found.rhats, ElementsAre(Pair("log posterior", testing::_)));
  EXPECT_EQ(found.ess_model, found.ess_log_posterior) << "nothing else changes";
}

// Every draw fifty times: the effective draws are a fiftieth, about 320 of 16 000.
TEST(Mixing, RareTransitionsAreTooFewUnlessTheProbabilityIsKnown) {
  for (const bool rare : {false, true}) {
    Posterior posterior = made_up::run({rare ? std::vector{0.998, 0.002, 0.0}  // known to 3.5e-4
                                             : std::vector{0.6, 0.4, 0.0}});
    if (!rare) {
      for (Chain& chain : posterior.chains) {
        for (std::size_t i = 0; i < chain.size(); ++i) chain.model[i] = chain.model[i - i % 50];
      }
    }
    const Mixing found = mixed(posterior);
    EXPECT_EQ(found.too_few, !rare);
    if (!rare) {
      EXPECT_NEAR(found.ess_model, 320.0, 80.0);
    }
  }
}

TEST(Mixing, JudgesWatchedQuantitiesAndNamesTheWorst) {
  const Posterior posterior = made_up::run({{0.6, 0.3, 0.1}});
  const Mixing found = mixed(posterior, {{"first location", [] { return quantity(0.0); }},
                                         {"side", [] { return quantity(1.0); }}});
  ASSERT_EQ(found.rhats.size(), 6U);
  EXPECT_EQ(found.rhats[4].first, "first location");
  EXPECT_LT(found.rhats[4].second, kLimits.rhat);
  EXPECT_EQ(found.rhat_worst, "side");
  EXPECT_EQ(found.rhat_max, found.rhats[5].second);
  // Means 0 to 3 of variance 1: R² = 1 + 5/3 in the limit, by ranks a little less.
  EXPECT_NEAR(found.rhat_max, std::sqrt(1.0 + 5.0 / 3.0), 0.2);
}

TEST(Mixing, RhatOfNaNIsTheWorst) {
  const Posterior posterior = made_up::run({{0.6, 0.3, 0.1}});
  const Mixing found = mixed(posterior, {{"broken",
                                          [] {
                                            return ChainsOf(4, {kNaN, 0.0, 1.0, 2.0});
                                          }},
                                         {"side", [] { return quantity(1.0); }}});
  EXPECT_EQ(found.rhat_worst, "broken");
  EXPECT_TRUE(std::isnan(found.rhat_max));
}

TEST(Mixing, JudgesCountsOfComponentsInsteadOfModels) {
  Posterior posterior;
  posterior.space = std::make_shared<const ModelSpace>(ModelSpace::of_components(
      {}, {{"crack", "cracks", {{"place", Uniform{0.0, 1.0}}}}}, {{{0}, 1.0}, {{1}, 1.0}}));
  posterior.dimension = 1;
  for (const Chain& of_three : made_up::run({{0.5, 0.5, 0.0}}).chains) {
    Chain chain = of_three;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      chain.theta[i] = chain.model[i] == 1 ? 0.5 : kNaN;
    }
    posterior.chains.push_back(std::move(chain));
  }
  EXPECT_THAT(mixed(posterior).rhats,
              ElementsAre(Pair("log posterior", testing::_), Pair("number of cracks", testing::_)));
}

}  // namespace
}  // namespace wheeltap::inference
