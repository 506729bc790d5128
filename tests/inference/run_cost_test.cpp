// Likelihood calls of the stages, cost of a quick run, estimates before a run, and results of a
// stopped run.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "inference/diagnosis/verdict.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/engine/run_cost.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

// n = 20, mean 0.5, sd 1, prior N(0, 1): a Bayes factor of 2.360070 for the free mean.
Problem nested_mean() {
  class NormalMean : public Likelihood {
   public:
    double log_likelihood(int model, std::span<const double> x) override {
      const double mu = model == 0 ? 0.0 : x[0];
      return -0.5 * 20.0 * (0.5 - mu) * (0.5 - mu);
    }
  };
  return {.space = ModelSpace::of_models({{"mu", Normal{0.0, 1.0}}},
                                         {{"zero", 1, {}}, {"free", 1, {"mu"}}}),
          .likelihood = [] { return std::make_unique<NormalMean>(); }};
}

TEST(RunCost, CallsOfTheStagesAddUp) {
  const Problem problem = toy::bumps();
  const Posterior posterior = reversible_jump(problem, {.warmup = 2000, .draws = 500});
  const Calls& calls = posterior.calls;
  EXPECT_EQ(calls.explore + calls.tune + calls.sample + calls.evidence,
            posterior.likelihood_evaluations);
  EXPECT_EQ(calls.explore + calls.tune, posterior.warmup_evaluations);
  EXPECT_GT(calls.tune, 0);
  EXPECT_GT(calls.sample, 2000);
}

// Correlated normal likelihood in six dimensions, as if it were costly.
Problem costly_normal() {
  class Normals : public Likelihood {
   public:
    double log_likelihood(int /*model*/, std::span<const double> x) override {
      double sum = 0.0, before = 0.3;
      for (const double v : x) {
        const double r = (v - 0.8 * before) / 0.1;
        sum -= 0.5 * r * r;
        before = v;
      }
      return sum;
    }
  };
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 0; i < 6; ++i) {
    names.push_back("a" + std::to_string(i));
    parameters.push_back({names.back(), Normal{0.0, 1.0}});
  }
  Problem out{.space = ModelSpace::of_models(std::move(parameters), {{"only", 1.0, names}}),
              .likelihood = [] { return std::make_unique<Normals>(); }};
  out.costly = true;
  return out;
}

// The first mixture fits: one round of tuning suffices, and the moves of SMC are screened.
TEST(RunCost, CostlyNormalPosteriorNeedsFewEvaluations) {
  const Problem problem = costly_normal();
  const Posterior posterior = reversible_jump(problem, {});
  EXPECT_TRUE(posterior.converged());
  EXPECT_LE(posterior.calls.tune, 4 * 2500);
  EXPECT_LE(posterior.calls.search, 110'000);
  EXPECT_LE(posterior.calls.anneal, 25'000);
}

// A damped oscillation a e^(-bt) cos(wt), with or without damping, in 400 samples: a record that
// can be shortened, with one mode per model.
Problem decay(long samples) {
  class Decay : public Likelihood {
   public:
    explicit Decay(long samples) : samples_(samples) {}
    double log_likelihood(int model, std::span<const double> x) override {
      double sum = 0.0;
      for (long i = 0; i < samples_; ++i) {
        const double t = 0.02 * static_cast<double>(i);
        const double y = std::exp(-0.3 * t) * std::cos(2.0 * t) +
                         0.02 * std::sin(7.0 * static_cast<double>(i * i));
        const double r =
            (y - x[0] * std::exp(model > 0 ? -x[2] * t : 0.0) * std::cos(x[1] * t)) / 0.02;
        sum -= 0.5 * r * r;
      }
      return sum;
    }

   private:
    long samples_;
  };
  return {.space = ModelSpace::of_models(
              {{"a", Normal{0.0, 2.0}}, {"w", Uniform{0.0, 5.0}}, {"b", Uniform{0.0, 2.0}}},
              {{"lossless", 1, {"a", "w"}}, {"damped", 1, {"a", "w", "b"}}}),
          .likelihood = [samples] { return std::make_unique<Decay>(samples); },
          .samples = samples,
          .shortened = [](long first) { return std::make_shared<const Problem>(decay(first)); }};
}

// Regression: warm-up took 2.9 times as many calls as the draws. A record has two iterations per
// draw and half the tuning, and tuning must not continue for a negligible model.
TEST(RunCost, WarmUpCostsAtMostAsMuchAsTheDrawsForASingleMode) {
  const Posterior posterior = reversible_jump(decay(400), {});
  EXPECT_TRUE(posterior.converged());
  EXPECT_LE(posterior.warmup_evaluations, posterior.calls.sample);
  EXPECT_EQ(posterior.thin, 2);
  EXPECT_LE(posterior.calls.tune, 4 * 17000);
}

// A line through data, or a constant.
Problem lines() {
  class Line : public Likelihood {
   public:
    double log_likelihood(int model, std::span<const double> x) override {
      double sum = 0.0;
      for (int i = 0; i < 20; ++i) {
        const double t = 0.1 * i, y = 1.0 + 0.5 * t + 0.05 * std::sin(7.0 * i);
        const double r = (y - x[0] - (model > 0 ? x[1] * t : 0.0)) / 0.05;
        sum -= 0.5 * r * r;
      }
      return sum;
    }
  };
  return {.space = ModelSpace::of_models({{"a", Normal{0.0, 2.0}}, {"b", Normal{0.0, 2.0}}},
                                         {{"constant", 1, {"a"}}, {"line", 1, {"a", "b"}}}),
          .likelihood = [] { return std::make_unique<Line>(); },
          .samples = 20,
          .shortened = [](long) { return std::make_shared<const Problem>(lines()); }};
}

// The constant is hundreds of nats below the line: climbs show this, and SMC is omitted for the
// expensive likelihood of a record.
TEST(RunCost, OmitsSmcForANegligibleModel) {
  const Posterior posterior = reversible_jump(lines(), {.warmup = 1000, .draws = 500});
  EXPECT_TRUE(std::isnan(posterior.found[0].annealed.log_evidence));
  EXPECT_TRUE(std::isfinite(posterior.found[0].sampled.log_evidence));
  EXPECT_TRUE(std::isfinite(posterior.found[1].annealed.log_evidence));
}

TEST(RunCost, QuickRunIsCheapAndMarked) {
  const Problem problem = nested_mean();
  const Posterior full = reversible_jump(problem, {});
  const Posterior look = reversible_jump(problem, {.quick = true});
  EXPECT_TRUE(look.quick);
  EXPECT_FALSE(full.quick);
  EXPECT_LT(50 * look.likelihood_evaluations, full.likelihood_evaluations);
  EXPECT_FALSE(look.converged());
  ASSERT_FALSE(look.why_not().empty());
  EXPECT_TRUE(std::holds_alternative<QuickLook>(look.why_not()[0]));
  EXPECT_NEAR(look.probability(1).value, 2.360070 / 3.360070, 0.1);
}

// A run stopped at any time returns at least draws based on its findings.
class Stopped : public testing::TestWithParam<std::pair<const char*, bool>> {};

TEST_P(Stopped, HasDrawsOfTheFindings) {
  const auto [stage, components] = GetParam();
  const Problem problem = components ? toy::bumps() : lines();
  bool reached = false;
  Options options{.seed = 1, .draws = 20000};
  options.progress = [&, stage = stage](const Options::Progress& p) {
    reached = reached || std::string(p.stage) == stage;
    return !reached;
  };
  const Posterior posterior = reversible_jump(problem, options);
  ASSERT_TRUE(reached) << stage;
  EXPECT_TRUE(posterior.stopped_early);
  ASSERT_GE(posterior.draws, 100);
  for (const Chain& chain : posterior.chains) {
    EXPECT_EQ(chain.size(), static_cast<std::size_t>(posterior.draws));
    for (const double l : chain.log_likelihood) EXPECT_TRUE(std::isfinite(l));
  }
  const Verdict verdict = judge(posterior);
  EXPECT_FALSE(verdict.converged);
  double sum = 0.0;
  for (const ModelStanding& s : verdict.models) sum += s.probability;
  EXPECT_NEAR(sum, 1.0, 1e-9);
  if (components) return;
  EXPECT_GT(verdict.models[1].probability, 0.99);
  ASSERT_FALSE(posterior.found[1].modes.empty());
  EXPECT_NEAR(posterior.found[1].modes[0].x[1], 0.5, 0.05);
}

INSTANTIATE_TEST_SUITE_P(RunCost, Stopped,
                         testing::Values(std::pair{"annealing", false}, std::pair{"tuning", false},
                                         std::pair{"sampling", false}, std::pair{"searching", true},
                                         std::pair{"exploring", true}, std::pair{"tuning", true},
                                         std::pair{"sampling", true}),
                         [](const auto& at) {
                           return std::string(at.param.first) +
                                  (at.param.second ? "_sets" : "_list");
                         });

// Stopped during the first model's search: the result has the modes found so far.
TEST(RunCost, StoppedInItsFirstSearchKeepsItsModes) {
  int calls = 0;
  Options options;
  options.progress = [&](const Options::Progress&) { return ++calls < 2; };
  const Posterior posterior = reversible_jump(lines(), options);
  EXPECT_TRUE(posterior.stopped_early);
  EXPECT_FALSE(posterior.found.empty() || posterior.found[0].modes.empty());
}

constexpr double kNoFolder = std::numeric_limits<double>::infinity();

TEST(RunCost, CountsLikelihoodsByChainsAndDraws) {
  const ProblemSize size{.dimensions = 2.0, .largest = 2.0, .seconds_a_likelihood = 1e-3};
  const Options options{.chains = 2, .threads = 1, .warmup = 1000, .draws = 500};
  const RunCost cost = cost_of_sampling(size, options, kNoFolder);
  EXPECT_DOUBLE_EQ(cost.likelihoods, 2.0 * (1000.0 + 4.0 * 500.0));
  EXPECT_DOUBLE_EQ(cost.seconds, 1e-3 * cost.likelihoods);
  EXPECT_EQ(cost.disk, 0.0);
}

TEST(RunCost, KeepsDrawsOnTheDiskAboveTheLimitOfMemory) {
  const ProblemSize size{.largest = 10.0};
  const Options options{.chains = 4, .warmup = 1000, .draws = 1'000'000};
  const RunCost in_memory = cost_of_sampling(size, options, kNoFolder);
  const RunCost on_disk = cost_of_sampling(size, options, 64e6);
  EXPECT_EQ(in_memory.disk, 0.0);
  EXPECT_GT(on_disk.disk, 4e6 * 8.0 * 10.0);
  EXPECT_LT(on_disk.bytes, in_memory.bytes);
}

}  // namespace
}  // namespace wheeltap::inference
