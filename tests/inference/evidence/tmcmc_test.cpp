#include "inference/evidence/tmcmc.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

bool long_tests() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

// The standard error is a Student t's sd with 7 degrees of freedom; six of these are exceeded with
// probability 2 · P(t₇ > 7.1) = 2e-4.
constexpr double kErrors = 6.0;

TEST(Tmcmc, AgreesWithClosedForms) {
  const std::vector<Known> all = {
      linear_gaussian(1),  linear_gaussian(3), linear_gaussian(6), two_narrow_modes(1),
      two_narrow_modes(3), exchangeable(1),    exchangeable(3),    corner()};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Tmcmc result = tmcmc(all[i].problem, 0, {.seed = 1, .samples = 300});
    EXPECT_NEAR(result.evidence.log_evidence, all[i].log_evidence,
                kErrors * result.evidence.standard_error)
        << "problem " << i;
    EXPECT_LT(result.evidence.standard_error, 0.25) << "problem " << i;
    EXPECT_GT(result.evidence.likelihood_evaluations, 0);
  }
}

TEST(Tmcmc, KeepsModesInProportion) {
  const Known known = two_narrow_modes(2);
  const Tmcmc result = tmcmc(known.problem, 0, {.seed = 2});
  double right = 0.0;
  for (Eigen::Index i = 0; i < result.z.rows(); ++i) right += result.z(i, 0) > 0.0 ? 1.0 : 0.0;
  // 4000 samples minus the loss by resampling; the replicates show a standard error of 2 %.
  EXPECT_NEAR(right / static_cast<double>(result.z.rows()), 0.75, 0.08);
}

// The approximation has an error of sd 0.5 along the posterior.
TEST(Tmcmc, IsExactWithAnApproximationThatSavesEvaluations) {
  const Known known = linear_gaussian(6);
  const auto likelihood = known.problem.likelihood();
  const LogApproximation approximation = [&](std::span<const double> z) {
    std::vector<double> x(z.begin(), z.end());
    for (double& v : x) v = 1.0 + 2.0 * v;  // the prior is N(1, 2²)
    return likelihood->log_likelihood(0, x) + 0.7 * std::sin(20.0 * z[0]);
  };
  double squares = 0.0, covered = 0.0;
  long plain = 0, screened = 0;
  constexpr int kSeeds = 20;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TmcmcOptions options{.seed = seed, .samples = 200, .threads = 1};
    plain += tmcmc(known.problem, 0, options).evidence.likelihood_evaluations;
    options.approximation = approximation;
    const Tmcmc result = tmcmc(known.problem, 0, options);
    EXPECT_GT(result.screened, result.stages);  // of 16 half-stages a stage
    screened += result.evidence.likelihood_evaluations;
    const double z =
        (result.evidence.log_evidence - known.log_evidence) / result.evidence.standard_error;
    squares += z * z / kSeeds;
    covered += std::fabs(z) < 1.96 ? 1.0 : 0.0;
  }
  std::printf("    %ld evaluations instead of %ld, rms error %.2f standard errors\n", screened,
              plain, std::sqrt(squares));
  EXPECT_LT(screened, plain * 2 / 3);
  // Nominal 0.95; less than 0.75 of 20 has a probability below 1e-3.
  EXPECT_GE(covered, 0.75 * kSeeds);
}

// The approximation has only the mode with a quarter of the probability.
TEST(Tmcmc, KeepsModesThatTheApproximationLacks) {
  const Known known = two_narrow_modes(2);
  TmcmcOptions options{.seed = 2};
  options.approximation = [](std::span<const double> z) {
    double sum = 0.0;
    for (const double v : z) sum -= 0.5 * (v + 1.0) * (v + 1.0) / (0.05 * 0.05);
    return sum;
  };
  const Tmcmc result = tmcmc(known.problem, 0, options);
  double right = 0.0;
  for (Eigen::Index i = 0; i < result.z.rows(); ++i) right += result.z(i, 0) > 0.0 ? 1.0 : 0.0;
  EXPECT_NEAR(right / static_cast<double>(result.z.rows()), 0.75, 0.08);
  EXPECT_NEAR(result.evidence.log_evidence, known.log_evidence,
              kErrors * result.evidence.standard_error);
}

TEST(Tmcmc, NestedMeans) {
  const Problem problem = nested_means();
  const Tmcmc null = tmcmc(problem, 0, {}), free = tmcmc(problem, 1, {});
  EXPECT_EQ(null.evidence.standard_error, 0.0);
  EXPECT_EQ(null.evidence.log_evidence, -2.5);
  EXPECT_NEAR(free.evidence.log_evidence - null.evidence.log_evidence, std::log(2.360070),
              kErrors * free.evidence.standard_error);
  EXPECT_LT(free.evidence.standard_error, 0.03);
}

TEST(Tmcmc, StandardErrorCovers) {
  const int seeds = long_tests() ? 200 : 25;
  for (const Known& known : {linear_gaussian(2), two_narrow_modes(2)}) {
    int inside = 0;
    double squares = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Evidence e =
          tmcmc(known.problem, 0,
                {.seed = static_cast<std::uint64_t>(seed), .samples = long_tests() ? 500 : 200})
              .evidence;
      const double z = (e.log_evidence - known.log_evidence) / e.standard_error;
      inside += std::fabs(z) < 1.96 ? 1 : 0;
      squares += z * z / seeds;
    }
    // Nominal 0.95; less than 0.80 of 25 (0.90 of 200) has a probability below 1e-3.
    EXPECT_GE(inside, seeds * (long_tests() ? 0.90 : 0.80));
    RecordProperty("coverage", std::to_string(static_cast<double>(inside) / seeds));
    std::printf("    coverage of ± 1.96 standard errors: %d of %d (rms z %.2f)\n", inside, seeds,
                std::sqrt(squares));
  }
}

TEST(Tmcmc, FollowsAGrowingRecord) {
  Problem problem = logistic_map(400);
  // The posterior is within 3e-4 of the truth, with needles about 1e-9 wide.
  constexpr double kReach = 3e-4, kStep = 1e-10;
  LogisticMap likelihood(400);
  double sum = 0.0;
  for (double x = LogisticMap::kTruth - kReach; x < LogisticMap::kTruth + kReach; x += kStep)
    sum += std::exp(likelihood.log_likelihood(0, {&x, 1}));
  const double known = std::log(sum * kStep / (LogisticMap::kHigh - LogisticMap::kLow));
  const Evidence growing = tmcmc(problem, 0, {.seed = 1, .samples = 200}).evidence;
  EXPECT_NEAR(growing.log_evidence, known, kErrors * growing.standard_error);
  EXPECT_LT(growing.standard_error, 0.3);

  problem.shortened = nullptr;  // the control, with few samples
  const Evidence at_once = tmcmc(problem, 0, {.seed = 1, .samples = 60}).evidence;
  std::printf("    exact %.3f, growing %.3f ± %.3f, at once %.3f ± %.3f\n", known,
              growing.log_evidence, growing.standard_error, at_once.log_evidence,
              at_once.standard_error);
  EXPECT_GT(std::fabs(at_once.log_evidence - known), 0.5);
  EXPECT_GT(std::fabs(at_once.log_evidence - known), 3.0 * at_once.standard_error);
}

// Possible on 4e-4 of the prior, where a factor then weights the positions.
TEST(Tmcmc, ContinuesDrawingIfLittleOfThePriorIsPossible) {
  const Problem problem = one_model(
      {{"a", Uniform{0.0, 1.0}}, {"b", Uniform{0.0, 1.0}}}, [](int, std::span<const double> x) {
        return x[0] > 0.98 && x[1] > 0.98 ? 100.0 * (x[0] - 0.98)
                                          : -std::numeric_limits<double>::infinity();
      });
  const double exact = std::log(0.02 * (std::exp(2.0) - 1.0) / 100.0);
  const int seeds = long_tests() ? 100 : 15;
  double mean = 0.0, squares = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Evidence e =
        tmcmc(problem, 0, {.seed = static_cast<std::uint64_t>(seed), .samples = 100}).evidence;
    EXPECT_NEAR(e.log_evidence, exact, kErrors * e.standard_error) << seed;
    EXPECT_LT(e.standard_error, 0.4);
    mean += std::exp(e.log_evidence - exact) / seeds;
    squares += std::exp(2.0 * (e.log_evidence - exact)) / seeds;
  }
  // Z itself is unbiased: within 4 of its standard errors.
  EXPECT_NEAR(mean, 1.0, 4.0 * std::sqrt((squares - mean * mean) / (seeds - 1)));
  std::printf("    mean of Z / exact Z: %.3f ± %.3f\n", mean,
              std::sqrt((squares - mean * mean) / (seeds - 1)));
}

TEST(Tmcmc, WarnsWithoutEvidenceIfItDoesNotReachTheEnd) {
  const Tmcmc result =
      tmcmc(endless(), 0, {.seed = 1, .replicates = 4, .samples = 20, .acceptances = 0.1});
  EXPECT_TRUE(std::isnan(result.evidence.log_evidence));
  EXPECT_TRUE(std::isnan(result.evidence.standard_error));
  EXPECT_GT(result.evidence.likelihood_evaluations, 1000);
  EXPECT_EQ(result.z.rows(), 0);
  ASSERT_EQ(result.evidence.warnings.size(), 1U);
  const EvidenceWarning& warning = result.evidence.warnings[0];
  EXPECT_EQ(warning.kind, EvidenceWarning::Kind::stalled);
  EXPECT_GT(warning.value, 0.0);
  EXPECT_LT(warning.value, 1.0);
  EXPECT_EQ(describe(warning).find("TMCMC reached only "), 0U) << describe(warning);
}

// After its maximum number of calls, it returns draws of the tempered posterior reached, and no
// evidence.
TEST(Tmcmc, StopsAfterItsMaximumNumberOfCalls) {
  const Known known = linear_gaussian(2);
  const TmcmcOptions all{.seed = 1, .replicates = 4, .samples = 100};
  const Tmcmc whole = tmcmc(known.problem, 0, all);
  const long calls = whole.evidence.likelihood_evaluations;
  TmcmcOptions half = all;
  half.most_evaluations = calls / 2;
  const Tmcmc cut = tmcmc(known.problem, 0, half);
  EXPECT_TRUE(cut.cut);
  EXPECT_TRUE(std::isnan(cut.evidence.log_evidence));
  EXPECT_TRUE(cut.evidence.warnings.empty());
  EXPECT_LT(cut.evidence.likelihood_evaluations, 0.9 * static_cast<double>(calls));
  EXPECT_GE(cut.evidence.likelihood_evaluations, calls / 2);
  EXPECT_EQ(cut.z.rows(), 400);
  EXPECT_TRUE(cut.log_posterior.empty());

  TmcmcOptions enough = all;
  enough.most_evaluations = 2 * calls;
  const Tmcmc same = tmcmc(known.problem, 0, enough);
  EXPECT_FALSE(same.cut);
  EXPECT_EQ(same.evidence.log_evidence, whole.evidence.log_evidence);
  EXPECT_FALSE(whole.cut);
}

TEST(Tmcmc, DependsOnTheSeedAndNotOnThreads) {
  const Known known = linear_gaussian(2);
  const double one =
      tmcmc(known.problem, 0, {.seed = 3, .samples = 100, .threads = 1}).evidence.log_evidence;
  EXPECT_EQ(
      tmcmc(known.problem, 0, {.seed = 3, .samples = 100, .threads = 3}).evidence.log_evidence,
      one);
  EXPECT_NE(tmcmc(known.problem, 0, {.seed = 4, .samples = 100}).evidence.log_evidence, one);
}

TEST(Tmcmc, RejectsInvalidOptions) {
  const Known known = linear_gaussian(1);
  EXPECT_THROW((void)tmcmc(never(), 0, {}), LikelihoodError);
  EXPECT_THROW((void)tmcmc(known.problem, 0, {.replicates = 3}), std::invalid_argument);
  EXPECT_THROW((void)tmcmc(known.problem, 0, {.samples = 5}), std::invalid_argument);
  EXPECT_THROW((void)tmcmc(known.problem, 1, {}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::inference
