#include "inference/model_exploration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {
namespace {

const HardProblem& named(const std::string& name) {
  for (const HardProblem& problem : hard_problems())
    if (problem.name == name) return problem;
  throw std::invalid_argument("no problem '" + name + "'");
}

class Explored : public testing::TestWithParam<std::string> {};

TEST_P(Explored, EvidenceIsRightAndEveryModeIsInThePopulation) {
  const HardProblem& hard = named(GetParam());
  const int model = hard.problem.space.size() - 1;
  const ModelExploration found = explore_model(hard.problem, model, {.budget = 30000});
  const double exact = hard.log_evidence[static_cast<std::size_t>(model)];
  EXPECT_NEAR(found.sampled.log_evidence, exact, 4.9 * found.sampled.standard_error);
  EXPECT_LT(found.sampled.standard_error, 0.1);
  ASSERT_GT(found.population.cols(), 0);
  double sum = 0.0;
  for (const double share : found.shares) sum += share;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}
INSTANTIATE_TEST_SUITE_P(ModelExploration, Explored,
                         testing::Values("nested normal, 10-d", "equal modes, 2-d",
                                         "a mode of 3 %, 2-d", "spike, 3-d",
                                         "exponential edges, 3-d", "improbable peak, 4-d"));

TEST(ModelExploration, GivesModesTheirShares) {
  const HardProblem& hard = named("a mode of 3 %, 2-d");
  const ModelExploration found =
      explore_model(hard.problem, hard.problem.space.size() - 1, {.budget = 30000});
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_NEAR(std::min(found.shares[0], found.shares[1]), 0.03, 0.01);
}

TEST(ModelExploration, OfAModelWithoutParametersIsExact) {
  const HardProblem& hard = named("nested normal, 2-d");
  const ModelExploration found = explore_model(hard.problem, 0, {});
  EXPECT_NEAR(found.sampled.log_evidence, hard.log_evidence[0], 1e-12);
  EXPECT_EQ(found.sampled.standard_error, 0.0);
}

TEST(ModelExploration, AGlanceHasLaplacesEvidence) {
  const HardProblem& hard = named("nested normal, 5-d");
  const ModelExploration found =
      explore_model(hard.problem, 1, {.climbs = 2, .anneal = false, .climbs_only = true});
  EXPECT_NEAR(found.annealed.log_evidence, hard.log_evidence[1], 0.05);  // a normal posterior
  EXPECT_TRUE(std::isnan(found.sampled.log_evidence));
  EXPECT_LT(found.likelihood_evaluations, 500);
}

}  // namespace
}  // namespace wheeltap::inference
