#include "inference/search/simulated_annealing.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/inference/test_functions.hpp"

namespace wheeltap::inference {
namespace {

TEST(SimulatedAnnealing, FindsModes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Optimum valley = maximise_by_annealing(
        rosenbrock, 2, {.seed = seed, .evaluations = 100000, .final_temperature = 1e-7});
    EXPECT_NEAR(valley.z[0], 1.0, 0.05) << seed;
    const Optimum grid =
        maximise_by_annealing(rastrigin, 4, {.seed = seed, .evaluations = 100000, .start_sd = 2.0});
    EXPECT_NEAR(grid.value, 0.0, 1e-2) << seed;
    EXPECT_TRUE(grid.converged);
  }
}

TEST(SimulatedAnnealing, CountsAndKeepsToItsBudgetAndBound) {
  const auto rising = [](std::span<const double> z) { return z[0]; };
  const Optimum end = maximise_by_annealing(rising, 1, {.evaluations = 5000, .bound = 3.0});
  EXPECT_LE(end.evaluations, 5000);
  EXPECT_LE(end.z[0], 3.0);
  EXPECT_GT(end.z[0], 2.99);
  EXPECT_THROW((void)maximise_by_annealing(rising, 1, {.evaluations = 10}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::inference
