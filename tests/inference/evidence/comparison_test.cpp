#include "inference/evidence/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace wheeltap::inference {
namespace {

ModelSpace three() {
  return ModelSpace::of_models({{"a", Normal{0.0, 1.0}}},
                               {{"one", 1.0, {"a"}}, {"two", 2.0, {"a"}}, {"none", 1.0, {}}});
}

TEST(ImpliedProbabilities, WeighEvidenceByPrior) {
  const double never = -std::numeric_limits<double>::infinity();
  const ImpliedProbabilities p = implied_probabilities(
      three(), {{-1000.0, 0.1}, {-1000.0 + std::log(1.5), 0.2}, {never, 0.0}});
  EXPECT_NEAR(p.mean[0], 0.25, 1e-12);
  EXPECT_NEAR(p.mean[1], 0.75, 1e-12);
  EXPECT_EQ(p.mean[2], 0.0);
  // Two models: P = logistic of a difference whose variance is 0.1² + 0.2².
  EXPECT_NEAR(p.standard_error[0], 0.25 * 0.75 * std::hypot(0.1, 0.2), 1e-12);
  EXPECT_NEAR(p.standard_error[1], p.standard_error[0], 1e-12);
  EXPECT_EQ(p.standard_error[2], 0.0);
  EXPECT_THROW((void)implied_probabilities(three(), {{0.0, 0.0}}), std::invalid_argument);
}

// Fault: 1 - P of the most probable model was rounded to 0, so that its own evidence had no error.
TEST(ImpliedProbabilities, HaveErrorsOfNearlyCertainModels) {
  const double never = -std::numeric_limits<double>::infinity();
  const ImpliedProbabilities p =
      implied_probabilities(three(), {{0.0, 0.3}, {-276.0, 0.4}, {never, 0.0}});
  const double small = p.mean[1];
  EXPECT_LT(small, 1e-100);
  EXPECT_NEAR(p.standard_error[0] / small, 0.5, 1e-9);
  EXPECT_NEAR(p.standard_error[1] / small, 0.5, 1e-9);
  // Without an error of the certain model, the error of its probability is still finite.
  EXPECT_TRUE(std::isfinite(
      implied_probabilities(three(), {{0.0, std::nan("")}, {-276.0, 0.4}, {never, 0.0}})
          .standard_error[0]));
}

// Fault: an improbable model without an error made all other errors NaN, and no disagreement was
// reported.
TEST(ImpliedProbabilities, HaveErrorsBesideAnImprobableModelWithoutAnError) {
  const ImpliedProbabilities p =
      implied_probabilities(three(), {{0.0, 0.1}, {-0.5, 0.1}, {-276.0, std::nan("")}});
  for (const double error : p.standard_error) EXPECT_TRUE(std::isfinite(error));
  EXPECT_GT(p.standard_error[0], 0.01);
}

TEST(Disagreements, AreReportedOnlyBeyondTheCombinedError) {
  const ImpliedProbabilities implied{{0.5, 0.3, 0.2}, {0.03, 0.03, 0.0}};
  EXPECT_TRUE(disagreements({0.55, 0.25, 0.2}, {0.01, 0.01, 0.01}, implied).empty());
  const auto two = disagreements({0.65, 0.15, 0.2}, {0.01, 0.01, 0.01}, implied);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].model, 0);
  EXPECT_EQ(two[0].sampled, 0.65);
}

TEST(Disagreements, AreNotReportedIfAnErrorIsUnknown) {
  // Laplace's evidences have no standard error, so their difference is not judged.
  const double unknown = std::nan("");
  const ImpliedProbabilities implied =
      implied_probabilities(three(), {{0.0, unknown}, {0.5, unknown}, {1.0, unknown}});
  EXPECT_TRUE(std::isnan(implied.standard_error[0]));
  EXPECT_TRUE(disagreements({0.9, 0.05, 0.05}, {0.01, 0.01, 0.01}, implied).empty());
}

}  // namespace
}  // namespace wheeltap::inference
