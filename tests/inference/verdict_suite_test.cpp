// The verdict on problems with known answers: found, flagged, or below the stated resolution.
//
// Short: the quick problems, one seed. WHEELTAP_LONG_TESTS=1: all problems, five seeds. A correct
// run exceeds 4 reported errors with probability 6e-5 per model.
#include <gtest/gtest.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>

#include "inference/engine/reversible_jump.hpp"
#include "tests/inference/hard_verdict.hpp"
#include "tests/inference/published_problems.hpp"

namespace wheeltap::inference {
namespace {

bool long_verdict_tests() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

void check(const HardProblem& problem) {
  for (int seed = 1; seed <= (long_verdict_tests() ? 5 : 1); ++seed) {
    const Posterior posterior = reversible_jump(
        problem.problem, {.seed = static_cast<std::uint64_t>(seed), .balance = problem.balance});
    const Verdict verdict = judge(posterior);
    const Assessment a = assess(problem, verdict);
    const auto m = static_cast<std::size_t>(a.model);
    std::printf(
        "    seed %d: P(%s) = %.4f ± %.4f, exact %.4f (%.1f errors), %s, resolution %.1e, "
        "%ld calls, %.1f s\n",
        seed, problem.problem.space[a.model].name.c_str(), verdict.models[m].probability,
        verdict.models[m].mcse, problem.probability[m], a.reported_errors,
        verdict.converged ? "converged" : "flagged", verdict.resolution,
        posterior.likelihood_evaluations, posterior.wall_seconds);
    for (const Reason& reason : verdict.not_established)
      std::printf("      %s\n", describe(reason, *posterior.space).c_str());
    EXPECT_TRUE(a.right) << problem.name << ", seed " << seed;
    if (problem.asked == Asked::found) {
      EXPECT_TRUE(verdict.converged) << problem.name << ", seed " << seed;
      EXPECT_LE(a.reported_errors, kReportedErrors) << problem.name << ", seed " << seed;
    }
    if (problem.balance) {
      const double factor = problem.probability[1] / problem.probability[0];
      EXPECT_NEAR(verdict.models[1].probability / verdict.models[0].probability, factor,
                  0.01 * factor);
    }
  }
}

class VerdictSuite : public testing::TestWithParam<std::size_t> {};

TEST_P(VerdictSuite, IsCorrect) {
  const HardProblem& problem = hard_problems()[GetParam()];
  if (!problem.quick && !long_verdict_tests()) GTEST_SKIP() << "belongs to the long suite";
  check(problem);
}

INSTANTIATE_TEST_SUITE_P(All, VerdictSuite, testing::Range<std::size_t>(0, hard_problems().size()),
                         [](const testing::TestParamInfo<std::size_t>& at) {
                           return identifier(hard_problems()[at.param].name);
                         });

TEST(VerdictSuiteOnData, RadiataPineWithinAPercent) {
  SKIP_WITHOUT_SHARED("radiata");
  check(radiata_problem((kShared / "validation" / "radiata").string()));
}

}  // namespace
}  // namespace wheeltap::inference
