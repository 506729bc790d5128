#include "inference/search/differential_evolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/inference/test_functions.hpp"

namespace wheeltap::inference {
namespace {

TEST(DifferentialEvolution, FollowsTheRosenbrockValley) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Optimum best = maximise_by_differential_evolution(
        rosenbrock, 5, {.seed = seed, .generations = 4000, .tolerance = 1e-12});
    EXPECT_TRUE(best.converged);
    for (const double x : best.z) EXPECT_NEAR(x, 1.0, 1e-4) << seed;
  }
}

TEST(DifferentialEvolution, LeavesLocalModes) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Optimum grid =
        maximise_by_differential_evolution(rastrigin, 6, {.seed = seed, .start_sd = 2.0});
    EXPECT_NEAR(grid.value, 0.0, 1e-6) << seed;
    const Optimum modes = maximise_by_differential_evolution(two_modes, 4, {.seed = seed});
    found += std::fabs(modes.value - 5.0) < 1e-6 ? 1 : 0;
  }
  // A few early members decide between the narrow modes, so that either is missed occasionally.
  EXPECT_GE(found, 7);
}

TEST(DifferentialEvolution, RespectsItsBoundAndImpossiblePoints) {
  const auto rising = [](std::span<const double> z) { return z[0] + z[1]; };
  const Optimum corner =
      maximise_by_differential_evolution(rising, 2, {.bound = 3.0, .tolerance = 1e-12});
  EXPECT_NEAR(corner.value, 6.0, 1e-6);
  const auto half = [](std::span<const double> z) {
    return z[0] < 0.5 ? std::nan("") : -z[0] * z[0];
  };
  EXPECT_NEAR(maximise_by_differential_evolution(half, 1, {}).z[0], 0.5, 1e-6);
}

TEST(DifferentialEvolution, DependsOnlyOnTheSeed) {
  const Optimum a =
      maximise_by_differential_evolution(rosenbrock, 3, {.seed = 7, .generations = 50});
  const Optimum b =
      maximise_by_differential_evolution(rosenbrock, 3, {.seed = 7, .generations = 50});
  EXPECT_EQ(a.z, b.z);
  EXPECT_THROW((void)maximise_by_differential_evolution(rosenbrock, 0, {}), std::invalid_argument);
  EXPECT_THROW((void)maximise_by_differential_evolution(rosenbrock, 2, {.population = 3}),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::inference
