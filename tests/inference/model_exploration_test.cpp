#include "inference/exploration/model_exploration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {
namespace {

const HardProblem& problem_named(const std::string& name) {
  for (const HardProblem& problem : hard_problems())
    if (problem.name == name) return problem;
  throw std::invalid_argument("no problem '" + name + "'");
}

class Explored : public testing::TestWithParam<std::string> {};

TEST_P(Explored, HasTheExactEvidenceAndEveryModeInItsPopulation) {
  const HardProblem& hard = problem_named(GetParam());
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

TEST(ModelExploration, ComputesTheSharesOfModes) {
  const HardProblem& hard = problem_named("a mode of 3 %, 2-d");
  const ModelExploration found =
      explore_model(hard.problem, hard.problem.space.size() - 1, {.budget = 30000});
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_NEAR(std::min(found.shares[0], found.shares[1]), 0.03, 0.01);
}

// The climbs settle this model; on a record, with an expensive likelihood, SMC only checks for
// missed probability mass.
TEST(ModelExploration, IsCheapForARecordWithOneMode) {
  const HardProblem& hard = problem_named("nested normal, 5-d");
  Problem record = hard.problem;
  record.samples = 100;
  record.shortened = [&](long) { return std::make_shared<const Problem>(hard.problem); };
  const ModelExploration found = explore_model(record, 1, {.climbs = 100});
  EXPECT_TRUE(found.settled());
  EXPECT_TRUE(std::isfinite(found.annealed.log_evidence));
  EXPECT_LT(found.calls.anneal, 15000);
  const ModelExploration in_full = explore_model(hard.problem, 1, {.climbs = 100});
  EXPECT_GT(in_full.calls.anneal, 2 * found.calls.anneal) << "the problem is not a record";
}

// Above 20 dimensions, the normal approximations at the posterior modes replace most likelihoods of
// SMC: twice as many samples as in 20 dimensions need fewer evaluations.
TEST(ModelExploration, ScreensMovesInManyDimensions) {
  const HardProblem& few = problem_named("nested normal, 20-d");
  const HardProblem& many = problem_named("nested normal, 40-d");
  const ModelExploration in_few = explore_model(few.problem, 1, {.climbs = 100, .particles = 400});
  const ModelExploration in_many =
      explore_model(many.problem, 1, {.climbs = 100, .particles = 400});
  EXPECT_NEAR(in_many.annealed.log_evidence, many.log_evidence[1],
              4.9 * in_many.annealed.standard_error);
  EXPECT_LT(in_many.calls.anneal, in_few.calls.anneal);
}

TEST(ModelExploration, TwoModesDoNotSettleAModel) {
  const HardProblem& hard = problem_named("equal modes, 2-d");
  EXPECT_FALSE(survey_model(hard.problem, 1, {.climbs = 100}).settled());
}

// Two climbs that end in one of two equal modes do not settle the model: SMC draws lie far from it,
// and a climb from them finds the other mode.
TEST(ModelExploration, BriefSmcFindsAModeThatTheClimbsMissed) {
  const HardProblem& hard = problem_named("equal modes, 2-d");
  ExplorationOptions options{.climbs = 2};
  for (options.seed = 1; options.seed < 20; ++options.seed) {
    if (survey_model(hard.problem, 1, options).settled()) break;
  }
  ASSERT_LT(options.seed, 20U) << "no seed whose climbs miss a mode";
  const ModelExploration found = explore_model(hard.problem, 1, options);
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_NEAR(found.shares[0], 0.5, 0.05);
  EXPECT_NEAR(found.sampled.log_evidence, hard.log_evidence[1], 4.9 * found.sampled.standard_error);
}

// Two equal modes, each a millionth of the prior wide in six dimensions, the second with the
// smaller basin: SMC on a record is cut short long before it reaches them.
Problem two_needles() {
  class Needles : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      double near = 0.0, far = 0.0;
      for (const double v : x) {
        near += 0.5 * std::pow((v - 0.45) / 1e-6, 2.0);
        far += 0.5 * std::pow((v - 0.85) / 1e-6, 2.0);
      }
      const double least = std::min(near, far);
      return -least + std::log(std::exp(least - near) + std::exp(least - far));
    }
  };
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 0; i < 6; ++i) {
    names.push_back("x" + std::to_string(i));
    parameters.push_back({names.back(), Uniform{0.0, 1.0}});
  }
  return {.space = ModelSpace::of_models(parameters, {{"needles", 1, names}}),
          .likelihood = [] { return std::make_unique<Needles>(); },
          .samples = 100,
          .shortened = [](long) { return std::make_shared<const Problem>(two_needles()); }};
}

TEST(ModelExploration, SmcCutShortFindsAModeThatTheClimbsMissed) {
  const Problem problem = two_needles();
  ExplorationOptions options{.climbs = 2};
  int tries = 0, hits = 0;
  for (options.seed = 1; options.seed < 60 && tries < 10; ++options.seed) {
    ModelExploration found = survey_model(problem, 0, options);
    if (!found.settled()) continue;  // the climbs found both modes
    ++tries;
    anneal_model(problem, 0, options, Annealing::brief, found);
    EXPECT_TRUE(std::isnan(found.annealed.log_evidence)) << "it was not cut short";
    EXPECT_LT(found.calls.anneal, 30000);
    EXPECT_EQ(found.annealed_draws.cols(), 0) << "these are no draws of the posterior";
    if (found.modes.size() != 2) continue;
    ++hits;
    EXPECT_NEAR(found.shares[0], 0.5, 0.05);
  }
  EXPECT_EQ(tries, 10) << "too few seeds whose climbs miss a mode";
  EXPECT_GE(hits, 6);  // about five sixths of the seeds
}

TEST(ModelExploration, IsExactForAModelWithoutParameters) {
  const HardProblem& hard = problem_named("nested normal, 2-d");
  const ModelExploration found = explore_model(hard.problem, 0, {});
  EXPECT_NEAR(found.sampled.log_evidence, hard.log_evidence[0], 1e-12);
  EXPECT_EQ(found.sampled.standard_error, 0.0);
}

TEST(ModelExploration, ClimbsAloneGiveLaplacesEvidence) {
  const HardProblem& hard = problem_named("nested normal, 5-d");
  const ModelExploration found =
      explore_model(hard.problem, 1, {.climbs = 2, .anneal = false, .climbs_only = true});
  EXPECT_NEAR(found.annealed.log_evidence, hard.log_evidence[1], 0.05);  // a normal posterior
  EXPECT_TRUE(std::isnan(found.sampled.log_evidence));
  EXPECT_LT(found.calls.sum(), 500);
}

}  // namespace
}  // namespace wheeltap::inference
