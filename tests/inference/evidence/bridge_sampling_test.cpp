#include "inference/evidence/bridge_sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

bool asked_for_long_tests() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

TEST(BridgeSampling, AgreesWithClosedForms) {
  const std::vector<Known> all = {linear_gaussian(1),  linear_gaussian(3),  linear_gaussian(6),
                                  two_narrow_modes(1), two_narrow_modes(3), exchangeable(1),
                                  exchangeable(3)};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Evidence e = bridge_sampling(all[i].problem, 0, {.seed = 1});
    EXPECT_NEAR(e.log_evidence, all[i].log_evidence, 4.5 * e.standard_error) << "problem " << i;
    EXPECT_LT(e.standard_error, 0.03) << "problem " << i;
    EXPECT_TRUE(e.warnings.empty()) << describe(e.warnings.front());
  }
}

TEST(BridgeSampling, NestedMeans) {
  const Problem problem = nested_means();
  EXPECT_EQ(bridge_sampling(problem, 0, {}).log_evidence, -2.5);
  const Evidence e = bridge_sampling(problem, 1, {});
  EXPECT_NEAR(e.log_evidence + 2.5, std::log(2.360070), 4.5 * e.standard_error);
  EXPECT_LT(e.standard_error, 0.01);
}

// Draws from a random walk are correlated, and the error must include this.
TEST(BridgeSampling, StandardErrorCovers) {
  const int seeds = asked_for_long_tests() ? 200 : 25;
  const Known known = linear_gaussian(3);
  int inside = 0;
  double squares = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto s = static_cast<std::uint64_t>(seed);
    const ModelSamples samples = metropolis(known.problem, 0, {.seed = s, .draws = 3000});
    const Evidence e = bridge_sampling(known.problem, 0, samples, {.seed = s});
    const double z = (e.log_evidence - known.log_evidence) / e.standard_error;
    inside += std::fabs(z) < 1.96 ? 1 : 0;
    squares += z * z / seeds;
  }
  EXPECT_GE(inside, seeds * (asked_for_long_tests() ? 0.90 : 0.80));
  std::printf("    coverage of ± 1.96 standard errors: %d of %d (rms z %.2f)\n", inside, seeds,
              std::sqrt(squares));
}

TEST(BridgeSampling, DoesNotDependOnThreads) {
  const Known known = two_narrow_modes(2);
  EXPECT_EQ(bridge_sampling(known.problem, 0, {.seed = 3, .threads = 1}).log_evidence,
            bridge_sampling(known.problem, 0, {.seed = 3, .threads = 3}).log_evidence);
}

TEST(BridgeSampling, WarnsWithoutEvidenceIfThePilotFails) {
  const Problem problem = endless();
  const Tmcmc pilot =
      tmcmc(problem, 0, {.seed = 1, .replicates = 4, .samples = 20, .acceptances = 0.1});
  const Evidence e = bridge_sampling(problem, 0, pilot, {});
  EXPECT_TRUE(std::isnan(e.log_evidence));
  EXPECT_TRUE(std::isnan(e.standard_error));
  ASSERT_EQ(e.warnings.size(), 1U);
  EXPECT_EQ(e.warnings[0].kind, EvidenceWarning::Kind::stalled);
}

TEST(BridgeSampling, RejectsInvalidOptions) {
  const Known known = linear_gaussian(1);
  const ModelSamples few = metropolis(known.problem, 0, {.warmup = 10, .draws = 10});
  EXPECT_THROW((void)bridge_sampling(known.problem, 0, few, {}), std::invalid_argument);
  EXPECT_THROW((void)bridge_sampling(never(), 0, {}), LikelihoodError);
}

}  // namespace
}  // namespace wheeltap::inference
