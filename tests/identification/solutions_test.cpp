#include "identification/findings/solutions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {
namespace {

using inference::Posterior;

/// Two parameters with standard normal priors.
class Density final : public inference::Likelihood {
 public:
  using Function = double (*)(double, double);
  explicit Density(Function log_density) : log_density_(log_density) {}
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    return log_density_(x[0], x[1]);
  }

 private:
  Function log_density_;
};

SeparateSolutions solutions_of(Density::Function log_density) {
  const inference::Problem problem = {
      .space = inference::ModelSpace::of_models(
          {{"a", inference::Normal{0.0, 1.0}}, {"b", inference::Normal{0.0, 1.0}}},
          {{"one", 1.0, {"a", "b"}}}),
      .likelihood = [log_density] { return std::make_unique<Density>(log_density); }};
  const Posterior posterior =
      inference::reversible_jump(problem, {.seed = 2, .chains = 4, .draws = 2000});
  return separate_solutions(posterior, 0);
}

double square(double x) {
  return x * x;
}

TEST(Solutions, TwoSeparateModesHaveTheirProbabilities) {
  const auto two = [](double a, double b) {
    // Weights 3 to 1 under a symmetric prior.
    return std::log(0.75 * std::exp(-0.5 * square((a - 1.0) / 0.05)) +
                    0.25 * std::exp(-0.5 * square((a + 1.0) / 0.05))) -
           0.5 * square((b - a) / 0.1);
  };
  const SeparateSolutions found = solutions_of(two);
  ASSERT_EQ(found.list.size(), 2U);
  EXPECT_NEAR(found.list[0].probability, 0.75, 6.0 * found.list[0].mcse + 1e-3);
  EXPECT_NEAR(found.list[0].probability + found.list[1].probability, 1.0, 1e-12);
  EXPECT_NEAR(found.list[0].parameters[0].q50, 1.0, 0.02);
  EXPECT_NEAR(found.list[1].parameters[0].q50, -1.0, 0.02);
  EXPECT_NEAR(found.list[1].best[0], -1.0, 0.05);
  // a and b are correlated between the solutions, but less within each.
  const Eigen::MatrixXd& c = found.covariance_within;
  EXPECT_LT(std::abs(c(0, 1)) / std::sqrt(c(0, 0) * c(1, 1)), 0.8);
  EXPECT_LT(c(0, 0), 0.01);
}

TEST(Solutions, OneModeGivesAnEmptyList) {
  EXPECT_TRUE(solutions_of([](double a, double b) {
                return -0.5 * (square(a / 0.1) + square(b));
              }).list.empty());
}

// A curved ridge is one solution.
TEST(Solutions, ACurvedRidgeIsOneSolution) {
  EXPECT_TRUE(solutions_of([](double a, double b) {
                return -0.5 * square((b - square(a) + 1.0) / 0.05);
              }).list.empty());
}

}  // namespace
}  // namespace wheeltap::identification
