// SMC draws outside a mixture: chains that start there do not leave it if the region belongs to the
// posterior, and return if it is an error of SMC.
#include "inference/engine/follow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string_view>

#include "inference/diagnosis/convergence.hpp"
#include "inference/engine/explore.hpp"
#include "inference/engine/sample.hpp"
#include "inference/engine/tune.hpp"
#include "inference/engine/weigh.hpp"
#include "inference/model/model_posterior.hpp"
#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kModel = 1;

const HardProblem& named(std::string_view name) {
  for (const HardProblem& p : hard_problems()) {
    if (p.name == name) return p;
  }
  throw std::invalid_argument("no such problem");
}

enum class Steps { small, all };

// A run with one normal as its model's mixture and no chain draws outside it.
struct Followed {
  Followed(const HardProblem& of, const NormalMixture::Component& normal, Steps steps)
      : options{.seed = 5,
                .chains = 2,
                .warmup = 2000,
                .draws = 300,
                .moves = {.birth_death = steps == Steps::all}},
        problem(of),
        run(problem.problem, options),
        state(begin(run)) {
    explore(run, state);
    tune(run, state);
    prepare_draws(run, state);
    settle(run, state);
    draw(run, state, 300);
    weigh(run, state);
    auto fit = std::make_shared<PilotFit>();
    fit->weight = state.pilot.fit->weight;
    fit->density.resize(fit->weight.size());
    fit->density[kModel] =
        std::make_unique<NormalMixture>(std::vector<NormalMixture::Component>{normal});
    state.pilot.fit = std::move(fit);
    if (steps == Steps::small) keep_near(normal);
    found().bridged.log_evidence = problem.log_evidence[kModel];
    found().beyond_mixture = 0.0;
    found().beyond_mixture_ess = 1000.0;
  }
  // Disables births from the prior, differences of draws and steps as long as the posterior, which
  // would lead from one mode in two dimensions to the other.
  void keep_near(const NormalMixture::Component& normal) {
    for (RandomWalk::Block& block : state.pilot.scales[kModel])
      block.factor = normal.factor.topLeftCorner(block.factor.rows(), block.factor.cols());
    auto archive = std::make_shared<Archive>(state.pilot.archive->size());
    Eigen::MatrixXd& of_normal = (*archive)[kModel];
    of_normal.resize(normal.mean.size(), 50);
    base::Random random(1, 0, 0, base::Purpose::test);
    for (double& z : of_normal.reshaped()) z = random.normal();
    of_normal = ((normal.factor * of_normal).colwise() + normal.mean).eval();
    state.pilot.archive = std::move(archive);
  }
  ModelFindings& found() { return state.posterior.found[kModel]; }

  const Options options;
  const HardProblem& problem;
  RunContext run;
  RunState state;
};

NormalMixture::Component normal(const Eigen::VectorXd& mean, double sd) {
  const auto d = mean.size();
  return {1.0, mean, sd * Eigen::MatrixXd::Identity(d, d)};
}

// Two equal modes, and a mixture that covers one of them.
TEST(FollowAnnealed, ChainsStayInAPartOfThePosterior) {
  const HardProblem& problem = named("equal modes, 2-d");
  // Mean of the draws on one side.
  Followed probe(problem, normal(Eigen::VectorXd::Zero(2), 1.0), Steps::small);
  const Eigen::MatrixXd& drawn = probe.state.explorations[kModel].annealed_draws;
  ASSERT_GT(drawn.cols(), 0);
  ASSERT_EQ(probe.state.explorations[kModel].annealed_log_posterior.size(),
            static_cast<std::size_t>(drawn.cols()));
  const double middle = drawn.row(0).mean();
  std::vector<Eigen::Index> left;
  for (Eigen::Index i = 0; i < drawn.cols(); ++i) {
    if (drawn(0, i) < middle) left.push_back(i);
  }
  const Eigen::MatrixXd of_left = drawn(Eigen::indexing::all, left);
  const Eigen::VectorXd mean = of_left.rowwise().mean();
  const double sd = std::sqrt((of_left.colwise() - mean).array().square().mean());

  Followed half(problem, normal(mean, sd), Steps::small);
  const auto met = follow_annealed(half.run, half.state);
  const double share = 1.0 - static_cast<double>(left.size()) / static_cast<double>(drawn.cols());
  EXPECT_NEAR(half.found().annealed_beyond, share, 0.02);
  EXPECT_EQ(half.found().annealed_draws, drawn.cols());
  EXPECT_TRUE(lacks_annealed(half.found()));
  ASSERT_GT(met[kModel].cols(), 1000);
  EXPECT_GT(met[kModel].row(0).minCoeff(), middle) << "the draws met lie at the other mode";

  Followed whole(problem, normal(drawn.rowwise().mean(), 10.0 * sd + std::abs(mean[0] - middle)),
                 Steps::small);
  const auto none = follow_annealed(whole.run, whole.state);
  EXPECT_EQ(whole.found().annealed_beyond, 0.0);
  EXPECT_EQ(none[kModel].cols(), 0);
  EXPECT_FALSE(lacks_annealed(whole.found()));
}

// A Cauchy density of scale 1 in ± 1000, and 30 to 330 false SMC draws of it. Its true share
// outside a normal of scale 1 (beyond 4.4) is 14 %.
TEST(FollowAnnealed, ChainsReturnFromAnErrorOfSmc) {
  const HardProblem& problem = named("Cauchy, 1-d");
  const double unit = std::sqrt(2.0 * M_PI) / 2000.0;  // z of a uniform prior near its middle
  Followed cauchy(problem, normal(Eigen::VectorXd::Zero(1), unit), Steps::all);
  ModelExploration& explored = cauchy.state.explorations[kModel];
  ModelPosterior posterior(problem.problem, kModel);
  constexpr int kDraws = 300;
  explored.annealed_draws.resize(1, kDraws);
  explored.annealed_log_posterior.clear();
  for (int i = 0; i < kDraws; ++i) {
    const double z = (30.0 + i) * unit;
    explored.annealed_draws(0, i) = z;
    explored.annealed_log_posterior.push_back(posterior({&z, 1}).log_posterior());
  }
  (void)follow_annealed(cauchy.run, cauchy.state);
  EXPECT_LT(cauchy.found().annealed_beyond, 0.5) << "all of it, had nothing been followed";
}

}  // namespace
}  // namespace wheeltap::inference
