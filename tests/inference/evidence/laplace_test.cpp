#include "inference/evidence/laplace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

// Exact for a normal posterior, as are central differences of a quadratic.
TEST(Laplace, IsExactForALinearGaussianModel) {
  for (const int d : {1, 2, 4, 6}) {
    const Known known = linear_gaussian(d);
    const Laplace result = laplace(known.problem, 0, {});
    EXPECT_NEAR(result.evidence.log_evidence, known.log_evidence, 1e-6) << d;
    EXPECT_TRUE(std::isnan(result.evidence.standard_error));
    EXPECT_TRUE(result.evidence.warnings.empty());
  }
  const Laplace mean = laplace(nested_means(), 1, {});
  EXPECT_NEAR(mean.evidence.log_evidence + 2.5, std::log(2.360070), 1e-6);
  EXPECT_NEAR(mean.x[0], 10.0 / 21.0, 1e-6);
  EXPECT_NEAR(mean.covariance(0, 0), 1.0 / 21.0, 1e-7);
  const Laplace none = laplace(nested_means(), 0, {});
  EXPECT_EQ(none.evidence.log_evidence, -2.5);
  EXPECT_EQ(none.evidence.standard_error, 0.0);
}

TEST(Laplace, CoversOneModeOnly) {
  // The higher mode has ¾ of the evidence.
  const Known known = two_narrow_modes(2);
  EXPECT_NEAR(laplace(known.problem, 0, {.restarts = 20}).evidence.log_evidence,
              known.log_evidence + std::log(0.75), 1e-4);
}

TEST(Laplace, WarnsIfTheHessianIsNotDefinite) {
  // A likelihood that increases faster than the prior of z decreases: the only maximum is at the
  // search bound.
  const Problem flat = one_model({{"a", Normal{0.0, 1.0}}},
                                 [](int, std::span<const double> x) { return 0.6 * x[0] * x[0]; });
  const Laplace result = laplace(flat, 0, {});
  ASSERT_EQ(result.evidence.warnings.size(), 1U);
  EXPECT_EQ(result.evidence.warnings[0].kind, EvidenceWarning::Kind::no_maximum);
  EXPECT_TRUE(std::isnan(result.evidence.log_evidence));
  EXPECT_THROW((void)laplace(never(), 0, {}), LikelihoodError);
}

TEST(Laplace, WarnsIfThePosteriorIsNotNormal) {
  // Piecewise constant per element, as for a damage location: zero differences, but a narrow mode.
  const Problem steps = one_model({{"a", Uniform{0.0, 1.0}}}, [](int, std::span<const double> x) {
    const double element = std::floor(100.0 * x[0]) - 30.0;
    return -2.0 * element * element;
  });
  const Laplace result = laplace(steps, 0, {});
  ASSERT_EQ(result.evidence.warnings.size(), 1U);
  EXPECT_EQ(result.evidence.warnings[0].kind, EvidenceWarning::Kind::not_normal);
}

// Regression: a mode at the boundary of the possible region has no curvature, and the next search
// started from an empty list of points.
TEST(MaximumAPosteriori, IsFoundAtTheBoundaryOfALongRecordsPossibleParameters) {
  Problem edge = one_model({{"a", Normal{0.0, 1.0}}}, [](int, std::span<const double> x) {
    return x[0] > 0.0 ? -std::numeric_limits<double>::infinity() : 10.0 * x[0];
  });
  edge.samples = 200;
  edge.shortened = [edge](long n) {
    Problem part = edge;
    part.samples = n;
    return std::make_shared<const Problem>(part);
  };
  EXPECT_NEAR(maximum_a_posteriori(edge, 0, {}).z[0], 0.0, 1e-3);
}

TEST(Laplace, SearchesOnGrowingRecords) {
  const Problem growing = logistic_map(300);
  Problem at_once = growing;
  at_once.shortened = nullptr;  // the control
  const auto miss = [](const Problem& problem, std::uint64_t seed) {
    const ModeOptions options{
        .seed = seed, .restarts = 1, .generations = 40, .tolerance = 0.1, .check = false};
    return std::fabs(laplace(problem, 0, options).x[0] - LogisticMap::kTruth);
  };
  int missed_at_once = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    EXPECT_LT(miss(growing, seed), 1e-6) << seed;
    missed_at_once += miss(at_once, seed) > 1e-6 ? 1 : 0;
  }
  EXPECT_GE(missed_at_once, 1);
}

}  // namespace
}  // namespace wheeltap::inference
