// The state of a run between two rounds is a value: a copy continues bit for bit in another context
// with another copy of the problem, and does not affect the original.
#include "inference/engine/run_state.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <type_traits>
#include <vector>

#include "inference/engine/explore.hpp"
#include "inference/engine/run_context.hpp"
#include "inference/engine/sample.hpp"
#include "inference/engine/tune.hpp"
#include "inference/engine/weigh.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

static_assert(std::is_copy_constructible_v<RunState> && std::is_copy_assignable_v<RunState>);

constexpr int kStateDraws = 300;

using Round = void (*)(RunContext&, RunState&);

// All rounds of a run, in order.
std::vector<Round> rounds(bool tempered) {
  return {explore,
          tune,
          tempered ? Round([](RunContext& run, RunState& state) {
            state.posterior.tempered_draws = true;
            prepare_draws(run, state);
          })
                   : Round(prepare_draws),
          settle,
          [](RunContext& run, RunState& state) { draw(run, state, kStateDraws); },
          [](RunContext& run, RunState& state) { draw(run, state, kStateDraws); },
          [](RunContext& run, RunState& state) { weigh(run, state); }};
}

void expect_same_posterior(const Posterior& a, const Posterior& b) {
  ASSERT_EQ(a.chains.size(), b.chains.size());
  for (std::size_t c = 0; c < a.chains.size(); ++c) {
    EXPECT_EQ(a.chains[c].model, b.chains[c].model);
    EXPECT_EQ(a.chains[c].log_likelihood, b.chains[c].log_likelihood);
    EXPECT_EQ(a.chains[c].log_prior, b.chains[c].log_prior);
    EXPECT_EQ(a.chains[c].move, b.chains[c].move);
    for (std::size_t i = 0; i < a.chains[c].size(); ++i) {
      const Draw one = a.draw(c, i), other = b.draw(c, i);
      ASSERT_TRUE(std::ranges::equal(one.theta, other.theta));
    }
  }
  EXPECT_EQ(a.likelihood_evaluations, b.likelihood_evaluations);
  EXPECT_EQ(a.warmup, b.warmup);
  EXPECT_EQ(a.ladder_round_trips, b.ladder_round_trips);
  EXPECT_EQ(a.jumps_accepted, b.jumps_accepted);
  ASSERT_EQ(a.found.size(), b.found.size());
  for (std::size_t m = 0; m < a.found.size(); ++m) {
    if (std::isfinite(a.found[m].bridged.log_evidence)) {
      EXPECT_EQ(a.found[m].bridged.log_evidence, b.found[m].bridged.log_evidence);
    }
  }
}

class RunStateOf : public testing::TestWithParam<bool> {};

TEST_P(RunStateOf, InterruptionAfterEveryRoundDoesNotChangeTheRun) {
  const Options options{.seed = 3, .chains = 2, .warmup = 1000, .draws = 2 * kStateDraws};
  const Problem problem = toy::bumps();
  RunContext context(problem, options);
  RunState straight = begin(context);
  for (const Round round : rounds(GetParam())) round(context, straight);

  RunState state;
  {
    const Problem first = toy::bumps();
    RunContext run(first, options);
    state = begin(run);
  }
  for (const Round round : rounds(GetParam())) {
    const Problem again = toy::bumps();  // nothing of the earlier context remains
    RunContext run(again, options);
    resume(run, state);
    round(run, state);
  }
  EXPECT_GT(straight.posterior.draws, 0);
  expect_same_posterior(finish(context, straight), [&] {
    RunContext run(problem, options);
    return finish(run, state);
  }());
}

TEST_P(RunStateOf, CopiesAreIndependent) {
  const Options options{.seed = 4, .chains = 2, .warmup = 1000, .draws = kStateDraws};
  const Problem problem = toy::bumps();
  RunContext run(problem, options);
  RunState state = begin(run);
  const std::vector<Round> all = rounds(GetParam());
  for (std::size_t i = 0; i < 4; ++i) all[i](run, state);
  const RunState before = state;
  all[4](run, state);
  EXPECT_EQ(before.posterior.draws, 0);
  EXPECT_EQ(before.posterior.chains[0].size(), 0U);

  RunState again = before;
  RunContext other(problem, options);
  resume(other, again);
  all[4](other, again);
  expect_same_posterior(finish(run, state), finish(other, again));
}

INSTANTIATE_TEST_SUITE_P(Draws, RunStateOf, testing::Bool(),
                         [](const auto& at) { return at.param ? "Tempered" : "Plain"; });

}  // namespace
}  // namespace wheeltap::inference
