#include "inference/chains/tempering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "inference/moves/between_models/model_switch.hpp"
#include "inference/moves/random_walk.hpp"
#include "tests/inference/evidence/problems.hpp"
#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {
namespace {

std::unique_ptr<KernelMixture> kernels_of(const ModelSpace& space) {
  auto kernels = std::make_unique<KernelMixture>();
  kernels->add(0.5,
               std::make_unique<MetropolisHastings>(
                   "random walk", std::make_unique<RandomWalk>(RandomWalk::initial_scales(space))));
  kernels->add(
      0.5, std::make_unique<MetropolisHastings>("model switch", std::make_unique<ModelSwitch>()));
  return kernels;
}

struct Shares {
  std::vector<double> share;  ///< larger model's share at each rung, in the second half
  std::vector<double> cold_weights;
};

// The nested normal, whose larger model has nearly no mass at intermediate β.
Shares temper(bool balanced) {
  const HardProblem* hard = nullptr;
  for (const HardProblem& problem : hard_problems())
    if (problem.name == "nested normal, 10-d") hard = &problem;
  Target target(hard->problem, false);
  TemperedChain chain(
      target, geometric_ladder(12), [&] { return kernels_of(target.space()); }, 5, 0);
  chain.start();
  if (balanced) chain.balance_models();
  constexpr int kScans = 4000;
  for (int i = 0; i < kScans; ++i) chain.scan(3, true, base::Purpose::test);
  Shares run{.share = std::vector<double>(12, 0.0), .cold_weights = {}};
  for (int i = 0; i < kScans; ++i) {
    chain.scan(3, true, base::Purpose::test);
    for (int r = 0; r < 12; ++r)
      run.share[static_cast<std::size_t>(r)] +=
          (chain.state(r).model == 1 ? 1.0 : 0.0) / static_cast<double>(kScans);
  }
  run.cold_weights = chain.cold_weights();
  return run;
}

TEST(Tempering, WeightsKeepAModelOfLowTemperedEvidence) {
  const Shares balanced = temper(true);
  for (const double share : balanced.share) {
    EXPECT_GT(share, 0.2);
    EXPECT_LT(share, 0.8);
  }
  // At β = 1 the two are equally probable, so their weights are equal up to noise.
  EXPECT_NEAR(balanced.cold_weights[0] - balanced.cold_weights[1], 0.0, 1.5);
  // The control: without weights, the larger model is lost in the middle of the ladder.
  const Shares plain = temper(false);
  EXPECT_LT(*std::ranges::min_element(plain.share), 0.05);
}

TEST(Tempering, RoundTripsAreCountedFromTheReset) {
  const HardProblem& hard = hard_problems().front();
  Target target(hard.problem, false);
  TemperedChain chain(
      target, geometric_ladder(4), [&] { return kernels_of(target.space()); }, 1, 0);
  chain.start();
  for (int i = 0; i < 500; ++i) chain.scan(3, true, base::Purpose::test);
  EXPECT_GT(chain.round_trips(), 0);
  chain.reset_round_trips();
  EXPECT_EQ(chain.round_trips(), 0);
}

// Possible on 4e-4 of the prior: none of 1000 draws in two cases of three, none of 100 000 with a
// probability of e^-40.
Problem small_corner() {
  return one_model(
      {{"a", Uniform{0.0, 1.0}}, {"b", Uniform{0.0, 1.0}}}, [](int, std::span<const double> x) {
        return x[0] > 0.98 && x[1] > 0.98 ? 0.0 : -std::numeric_limits<double>::infinity();
      });
}

TEST(Tempering, FindsASmallFeasibleRegionInThePrior) {
  const Problem problem = small_corner();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Target target(problem, false);
    EXPECT_TRUE(check_models(target, seed).empty());
    base::Random random(seed, 0, 0, base::Purpose::test);
    const State state = start_from_prior(target, random);
    EXPECT_EQ(state.log_likelihood, 0.0);
    EXPECT_GT(state.x[0], 0.98);
  }
}

TEST(Tempering, ChecksForAStopBeforeEveryTry) {
  const Problem problem = never();
  Target target(problem, false);
  int asked = 0;
  EXPECT_NO_THROW((void)check_models(target, 1, [&](double tried) {
    EXPECT_DOUBLE_EQ(tried, asked / 100'000.0);
    return ++asked <= 10;
  }));
  EXPECT_EQ(asked, 11);
  EXPECT_EQ(target.evaluations(), 10);
}

TEST(Tempering, RejectsAnImpossibleModel) {
  const Problem problem = never();
  Target target(problem, false);
  try {
    static_cast<void>(check_models(target, 1));
    FAIL() << "no error";
  } catch (const LikelihoodError& error) {
    EXPECT_NE(std::string(error.what()).find("100000 tried"), std::string::npos) << error.what();
  }
  base::Random random(1, 0, 0, base::Purpose::test);
  EXPECT_THROW((void)start_from_prior(target, random), LikelihoodError);
}

}  // namespace
}  // namespace wheeltap::inference
