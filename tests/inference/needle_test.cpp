// Needles inside broad modes: the climbs find them, or they are narrower than the width that the
// run states as its resolution.
//
// Short: searches only, and one run. WHEELTAP_LONG_TESTS=1: runs of all, five seeds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "inference/engine/reversible_jump.hpp"
#include "inference/search/mode_search.hpp"
#include "tests/inference/hard_verdict.hpp"
#include "tests/inference/needle_problems.hpp"

namespace wheeltap::inference {
namespace {

bool has_the_needle(const ModeSearch& found, const NeedleProblem& problem) {
  const Prior& prior = problem.hard.problem.space.prior(1, 0);
  const double z = prior.to_standard_normal(problem.hard.hidden.front());
  for (const Mode& mode : found.modes)
    if (std::fabs(mode.z.front() - z) < problem.width) return true;
  return false;
}

class Needles : public testing::TestWithParam<std::size_t> {};

TEST_P(Needles, SearchFindsThemOrTheyAreBelowItsResolution) {
  const NeedleProblem& problem = needle_problems()[GetParam()];
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ModeSearch found =
        search_modes(problem.hard.problem, 1, {.seed = seed, .budget = 30'000, .threads = 1});
    const bool seen = has_the_needle(found, problem);
    const double limit =
        search_resolution(search_resolution(found.climbs), found.spacing, problem.width);
    EXPECT_TRUE(seen || problem.hard.basin < limit)
        << problem.hard.name << ", seed " << seed << ": limit " << limit << ", spacing "
        << found.spacing << ", width " << problem.width;
    if (problem.concentric) {
      EXPECT_TRUE(seen) << problem.hard.name << ", seed " << seed;
    }
  }
}

// The resolution for wide modes alone would be too small by a factor of hundreds.
TEST(Needle, ResolutionDependsOnTheWidth) {
  EXPECT_NEAR(search_resolution(5e-4, 0.2, 0.2), 5e-4, 1e-12);
  EXPECT_NEAR(search_resolution(5e-4, 0.2, 1.0), 5e-4, 1e-12);
  EXPECT_NEAR(search_resolution(5e-4, 0.2, 2e-3), 5e-2, 1e-12);
  EXPECT_EQ(search_resolution(5e-4, 0.2, 1e-8), 1.0);
  EXPECT_EQ(search_resolution(5e-4, 0.0, 1e-8), 5e-4) << "the spacing is not known";
}

void check_run(const NeedleProblem& problem, std::uint64_t seed) {
  const HardProblem& hard = problem.hard;
  const Verdict verdict = judge(reversible_jump(hard.problem, {.seed = seed}));
  const Assessment a = assess(hard, verdict);
  const double limit = verdict.resolution_of(problem.width);
  std::printf("    %s, seed %d: P = %.4f, exact %.4f (%.1f errors), %s, limit %.1e (%.1e wide)\n",
              hard.name.c_str(), static_cast<int>(seed), verdict.models[1].probability,
              hard.probability[1], a.reported_errors, verdict.converged ? "converged" : "flagged",
              limit, problem.width);
  EXPECT_TRUE(a.exact || !verdict.converged || hard.basin < limit) << hard.name << ", " << seed;
}

TEST_P(Needles, RunFindsOrFlagsThemOrTheyAreBelowItsResolution) {
  const bool long_tests = std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
  const NeedleProblem& problem = needle_problems()[GetParam()];
  if (!long_tests && problem.hard.name != "1-d, 1e-9, one centre at .43")
    GTEST_SKIP() << "belongs to the long suite";
  for (std::uint64_t seed = 1; seed <= (long_tests ? 5U : 1U); ++seed) check_run(problem, seed);
}

INSTANTIATE_TEST_SUITE_P(All, Needles, testing::Range<std::size_t>(0, needle_problems().size()),
                         [](const testing::TestParamInfo<std::size_t>& at) {
                           return "needle_" + identifier(needle_problems()[at.param].hard.name);
                         });

}  // namespace
}  // namespace wheeltap::inference
