// A run without likelihood returns the prior for any set of moves: a move that does not leave the
// prior invariant cannot leave a posterior invariant.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "inference/engine/reversible_jump.hpp"
#include "inference/moves/between_models/birth_death.hpp"
#include "tests/inference/run_checks.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

struct MoveSet {
  const char* name;
  Options::Moves moves;
};

class PriorRecovery : public testing::TestWithParam<MoveSet> {};

// Without likelihood, the counts follow their prior, and so do locations and heights. Ordered
// locations: the smallest of k from F is distributed as 1 - (1 - F)^k.
TEST_P(PriorRecovery, CountsLocationsAndHeights) {
  const std::vector<double> weights{3, 1, 4, 2};
  const Problem problem = toy::bump_problem(std::vector<double>(toy::kSensors, 1.0), weights);
  Options options = small();
  options.prior_only = true;
  options.moves = GetParam().moves;
  const Posterior posterior = reversible_jump(problem, options);
  for (int k = 0; k < 4; ++k) {
    expect_probability(posterior, k, weights[static_cast<std::size_t>(k)] / 10.0);
  }
  for (int k = 1; k < 4; ++k) {
    const Prior& location = problem.space.prior(k, 0);
    const Prior& height = problem.space.prior(k, 1);
    const auto cdf = [](const Prior& prior, double x) {
      return 0.5 * std::erfc(-prior.to_standard_normal(x) / std::numbers::sqrt2);
    };
    EXPECT_GT(ks_of_draws(posterior, k, 0,
                          [&](double x) { return 1.0 - std::pow(1.0 - cdf(location, x), k); }),
              1e-6);
    EXPECT_GT(ks_of_draws(posterior, k, 1, [&](double x) { return cdf(height, x); }), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(MoveSets, PriorRecovery,
                         testing::Values(MoveSet{"All", {}},
                                         MoveSet{"SourceOnly",
                                                 {.informed_birth = false,
                                                  .relocation = false,
                                                  .reflection = false,
                                                  .independence = false,
                                                  .tempering = false}},
                                         MoveSet{"WithoutIndependence", {.independence = false}},
                                         MoveSet{"MirrorsAndBirths",
                                                 {.informed_birth = false,
                                                  .random_walk = false,
                                                  .relocation = false,
                                                  .independence = false}},
                                         MoveSet{"IndependenceOnly",
                                                 {.birth_death = false,
                                                  .informed_birth = false,
                                                  .random_walk = false,
                                                  .relocation = false,
                                                  .reflection = false}}),
                         [](const auto& set) { return set.param.name; });

// The control: one move without its ratio among all correct ones; the result differs from the
// prior.
TEST(PriorRecoveryControl, DetectsAMissingRatio) {
  class Forgetful : public BirthDeath {
   public:
    using BirthDeath::BirthDeath;
    std::optional<double> propose(const State& from, const Step& step, State& to) override {
      if (!BirthDeath::propose(from, step, to)) return std::nullopt;
      return 0.0;
    }
  };
  Problem problem = toy::bump_problem(std::vector<double>(toy::kSensors, 1.0), {3, 1, 4, 2});
  problem.moves.push_back(
      {"forgetful birth",
       [] { return std::make_unique<Forgetful>(0, std::make_unique<PriorProposal>()); }});
  Options options = small();
  options.prior_only = true;
  const Posterior posterior = reversible_jump(problem, options);
  const double error = mcse_mean(indicator(posterior, 0));
  EXPECT_GT(std::abs(probability(posterior, 0) - 0.3), kSigmas * error);
}

// A flat likelihood with a Poisson prior returns that Poisson distribution, including k = 0.
TEST(ReversibleJump, FlatLikelihoodReturnsThePoissonPrior) {
  class Flat : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double>) override { return -3.0; }
  };
  std::vector<double> weights;
  double term = 1.0;
  for (int k = 0; k <= 9; ++k) {
    weights.push_back(term);
    term *= 3.0 / (k + 1);
  }
  double total = 0.0;
  for (const double w : weights) total += w;
  const Problem problem{.space = toy::bump_space(weights),
                        .likelihood = [] { return std::make_unique<Flat>(); }};
  const Posterior posterior = reversible_jump(problem, {.warmup = 3000, .draws = 10000});
  for (int k = 0; k <= 9; ++k)
    expect_probability(posterior, k, weights[static_cast<std::size_t>(k)] / total);
}

}  // namespace
}  // namespace wheeltap::inference
