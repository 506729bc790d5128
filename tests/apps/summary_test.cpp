#include "apps/summary.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "inference/random.hpp"

namespace wheeltap::apps {
namespace {

using inference::Posterior;
using testing::HasSubstr;

const inference::ModelSpace& coin_space() {
  static const auto space = inference::ModelSpace::of_components(
      {}, {{"damage", "damages", {{"location", inference::Uniform{0.0, 1.0}}}}},
      {{{0}, 0.5}, {{1}, 0.5}});
  return space;
}

// Independent draws: model 1 with probability p, its parameter uniform on [low, high] in chain c.
Posterior made_up(double p, int draws, double shift_of_last_chain = 0.0, double p_of_last = -1.0) {
  Posterior posterior;
  posterior.space = &coin_space();
  posterior.dimension = 1;
  posterior.draws = draws;
  for (std::uint64_t c = 0; c < 4; ++c) {
    inference::Random random(5, c, 0, inference::Purpose::test);
    inference::Chain chain;
    const double mine = c == 3 && p_of_last >= 0.0 ? p_of_last : p;
    for (int i = 0; i < draws; ++i) {
      const bool one = random.uniform() < mine;
      chain.model.push_back(one ? 1 : 0);
      chain.theta.push_back(one ? random.uniform() + (c == 3 ? shift_of_last_chain : 0.0)
                                : std::nan(""));
      chain.log_prior.push_back(0.0);
      chain.log_likelihood.push_back(random.normal() + (c == 3 ? shift_of_last_chain : 0.0));
    }
    posterior.chains.push_back(chain);
  }
  return posterior;
}

Report judged(const Posterior& posterior) {
  const Watched count{
      "number of damages",
      all_draws(posterior,
                [&](auto c, auto i) { return static_cast<double>(posterior.chains[c].model[i]); }),
      true};
  return diagnostics(posterior, {count}, ess_of_model(posterior), 1, {});
}

TEST(Summary, ModelTableOfIndependentDraws) {
  const Posterior posterior = made_up(0.3, 2000);
  const Report table = model_table(posterior, ess_of_model(posterior));
  const double mcse = std::sqrt(0.3 * 0.7 / 8000.0);
  EXPECT_EQ(table[1]["name"], "1 damage");
  EXPECT_EQ(table[1]["prior"], 0.5);
  EXPECT_NEAR(table[1]["probability"], 0.3, 4.5 * mcse);
  EXPECT_NEAR(table[1]["mcse"].get<double>() / mcse, 1.0, 0.2);
}

TEST(Summary, NeverVisitedModelsHaveAnErrorTooAndNoParameters) {
  const Posterior posterior = made_up(0.0, 1000);
  const Report table = model_table(posterior, ess_of_model(posterior));
  EXPECT_EQ(table[1]["probability"], 0.0);
  EXPECT_DOUBLE_EQ(table[1]["mcse"], 1.0 / 4002.0);
  EXPECT_FALSE(parameter_tables(posterior).contains("1 damage"));
}

TEST(Summary, ParameterSummary) {
  const Posterior posterior = made_up(0.5, 4000);
  const Report s = parameter_tables(posterior)["1 damage"]["location[1]"];
  const double n = 8000.0;
  EXPECT_NEAR(s["mean"], 0.5, 4.5 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(s["sd"], std::sqrt(1.0 / 12.0), 0.01);
  EXPECT_NEAR(s["q2.5"], 0.025, 0.01);
  EXPECT_NEAR(s["q97.5"], 0.975, 0.01);
  EXPECT_GT(s["ess_bulk"], 0.7 * n);
  EXPECT_LT(s["rhat"], 1.01);
}

TEST(Summary, ModeIsTheFullestBin) {
  inference::Random random(3, 0, 0, inference::Purpose::test);
  std::vector<double> draws;
  for (int i = 0; i < 20000; ++i) draws.push_back(std::exp(0.5 * random.normal()));
  // ln x ~ N(0, ½²): the mode is exp(-1/4).
  EXPECT_NEAR(summarise({draws})["mode"], std::exp(-0.25), 0.1);
}

TEST(Summary, QuantilesAreLinearBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0}, 0.75), 3.0);
}

TEST(Summary, GoodChainsConverge) {
  const Report d = judged(made_up(0.3, 2000));
  EXPECT_TRUE(d["converged"]);
  EXPECT_TRUE(d["warnings"].empty());
  EXPECT_GT(d["round_trips"], 500);
}

TEST(Summary, ChainsThatDisagreeAboutTheCountDoNot) {
  const Report d = judged(made_up(0.3, 2000, 0.0, 0.6));
  EXPECT_FALSE(d["converged"]);
  EXPECT_THAT(d["warnings"][0].get<std::string>(), HasSubstr("R-hat of number of damages"));
}

TEST(Summary, ChainsThatDisagreeAboutThePosteriorDoNot) {
  const Report d = judged(made_up(0.3, 2000, 2.0));
  EXPECT_FALSE(d["converged"]);
  EXPECT_THAT(d["warnings"][0].get<std::string>(), HasSubstr("R-hat of log posterior"));
}

TEST(Summary, ShortChainsDoNot) {
  const Report d = judged(made_up(0.3, 60));
  EXPECT_FALSE(d["converged"]);
}

TEST(Summary, ADominantModelIsJudgedWithoutItsCount) {
  const Report d = judged(made_up(1.0, 2000));
  EXPECT_TRUE(d["converged"]);
}

TEST(Summary, NumbersForPeople) {
  EXPECT_EQ(percent(0.749), "74.9 %");
  EXPECT_EQ(percent(0.0312), "3.1 %");
  EXPECT_EQ(percent(1.0), "> 99.9 %");
  EXPECT_EQ(percent(0.0), "< 0.1 %");
  EXPECT_EQ(probability_is(0.9999), "P > 99.9 %");
  EXPECT_EQ(rounded_count(80491.0), "80500");
  EXPECT_EQ(rounded_count(412.3), "412");
  EXPECT_EQ(resolved(464992.4, 10.2), "464992");
  EXPECT_EQ(resolved(49.99871, 0.02), "49.999");
  EXPECT_EQ(resolved(1022.8, 187.0), "1023");
  EXPECT_EQ(resolved(9.9949e-5, 4e-8), "9.9949e-05");
  EXPECT_EQ(resolved(28.3, 29.0), "28.3");
}

}  // namespace
}  // namespace wheeltap::apps
