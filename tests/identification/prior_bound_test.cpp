#include "identification/findings/prior_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.hpp"

namespace wheeltap::identification {
namespace {

std::vector<double> normal_draws(double mean, double sd, double low, double high) {
  base::Random random(3, 0, 0, base::Purpose::test);
  std::vector<double> out;
  while (out.size() < 4000)
    if (const double x = mean + sd * random.normal(); x > low && x < high) out.push_back(x);
  return out;
}

TEST(PriorBound, ANarrowPosteriorNearABoundKeepsAwayFromIt) {
  const inference::Prior wide = inference::Uniform{-0.999, 10.0};
  EXPECT_EQ(bound_of(wide, normal_draws(-0.731, 0.013, -0.999, 10.0)), PriorBound::none);
  EXPECT_EQ(bound_of(wide, normal_draws(9.9, 0.01, -0.999, 10.0)), PriorBound::none);
}

TEST(PriorBound, APosteriorCutOffByTheBoundPilesUp) {
  const inference::Prior wide = inference::Uniform{-0.999, 10.0};
  EXPECT_EQ(bound_of(wide, normal_draws(-0.999, 0.013, -0.999, 10.0)), PriorBound::lower);
  EXPECT_EQ(bound_of(wide, normal_draws(10.2, 0.2, -0.999, 10.0)), PriorBound::upper);
}

TEST(PriorBound, AnUnchangedPriorDoesNotPileUp) {
  std::vector<double> draws;
  for (int i = 0; i < 1000; ++i) draws.push_back((i + 0.5) / 1000.0);
  EXPECT_EQ(bound_of(inference::Prior(inference::Uniform{0.0, 1.0}), draws), PriorBound::none);
}

// For a positive quantity, zero is not a bound of the prior.
TEST(PriorBound, ZeroIsNotABoundOfThePrior) {
  EXPECT_EQ(
      bound_of(inference::Prior(inference::Uniform{0.0, 1.0}), normal_draws(0.0, 0.01, 0.0, 1.0)),
      PriorBound::none);
}

}  // namespace
}  // namespace wheeltap::identification
