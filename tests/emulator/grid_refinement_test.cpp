#include "emulator/grid_refinement.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>

#include "emulator/cubic_interpolant.hpp"
#include "emulator/gaussian_process.hpp"

namespace wheeltap::emulator {
namespace {

/// Sharp in the first factor, smooth in the second.
ModelFactory peaked(std::atomic<int>* calls = nullptr) {
  return [calls] {
    return [calls](std::span<const double> x, std::span<double> y) {
      if (calls) ++*calls;
      y[0] = 1.0 / (1.0 + 50.0 * (x[0] - 0.3) * (x[0] - 0.3)) + x[1];
      y[1] = std::exp(0.3 * x[0] * x[1]);
    };
  };
}

std::vector<Factor> coarse() {
  return {{"a", "", {0, 1}}, {"b", "", {0, 0.5, 1}}};
}

RefinementOptions options(double tolerance, const InterpolantType& type = kMultilinear) {
  return {.tolerance = {tolerance, tolerance}, .interpolant = &type};
}

TEST(GridRefinement, ReachesTheToleranceWithFewLevels) {
  const RefinedGrid grid = refine_grid(coarse(), 2, peaked(), options(0.01));
  EXPECT_TRUE(grid.reached);
  for (const HoldoutError& e : grid.holdout) EXPECT_LE(e.max_error, 0.01);
  EXPECT_GT(grid.factors[0].levels.size(), 10u);
  EXPECT_LT(grid.factors[1].levels.size(), 6u);
  EXPECT_EQ(grid.values.rows(), full_factorial(grid.factors).runs());
  // New points, not those of the refinement.
  const MultilinearInterpolant f(grid.factors, grid.values);
  const auto fresh =
      validate(coarse(), 2, peaked(),
               [&](std::span<const double> x, std::span<double> y) { f.evaluate(x, y); },
               {.runs = 500, .seed = 77});
  for (const HoldoutError& e : fresh) EXPECT_LE(e.max_error, 0.015);
}

TEST(GridRefinement, CubicNeedsFewerLevels) {
  const RefinedGrid linear = refine_grid(coarse(), 2, peaked(), options(0.002));
  const RefinedGrid cubic = refine_grid(coarse(), 2, peaked(), options(0.002, kMonotoneCubic));
  EXPECT_TRUE(linear.reached);
  EXPECT_TRUE(cubic.reached);
  EXPECT_LT(cubic.values.rows(), linear.values.rows());
}

TEST(GridRefinement, RunsNoPointTwice) {
  std::atomic<int> calls = 0;
  const RefinedGrid grid = refine_grid(coarse(), 2, peaked(&calls), options(0.01));
  EXPECT_EQ(calls, grid.model_runs);
}

TEST(GridRefinement, UsesLevelsFromCandidates) {
  RefinementOptions o = options(0.01);
  o.candidates = {{}, {}};
  for (int i = 0; i <= 40; ++i) o.candidates[0].push_back(i / 40.0);
  const RefinedGrid grid = refine_grid(coarse(), 2, peaked(), o);
  const std::set<double> allowed(o.candidates[0].begin(), o.candidates[0].end());
  for (double level : grid.factors[0].levels) EXPECT_TRUE(allowed.contains(level));
  // Only candidates are evaluated, so with a level at each of them no error remains on that axis.
  EXPECT_TRUE(grid.reached);
}

TEST(GridRefinement, ReportsAMissedTolerance) {
  RefinementOptions few = options(1e-6);
  few.most_runs = 50;
  const RefinedGrid grid = refine_grid(coarse(), 2, peaked(), few);
  EXPECT_FALSE(grid.reached);
  EXPECT_LE(grid.values.rows(), 50);
}

TEST(GridRefinement, DoesNotDependOnThreads) {
  RefinementOptions two = options(0.01);
  two.experiment.threads = 2;
  const RefinedGrid a = refine_grid(coarse(), 2, peaked(), options(0.01));
  const RefinedGrid b = refine_grid(coarse(), 2, peaked(), two);
  EXPECT_EQ(a.values, b.values);
}

TEST(GridRefinement, RejectsInvalidOptions) {
  EXPECT_THROW((void)refine_grid(coarse(), 3, peaked(), options(0.01)), std::invalid_argument);
  EXPECT_THROW((void)refine_grid(coarse(), 2, peaked(), options(0)), std::invalid_argument);
  EXPECT_THROW((void)refine_grid(coarse(), 2, peaked(), options(0.01, kGaussianProcess)),
               std::invalid_argument)
      << "it does not take a grid";
  RefinementOptions one_wave = options(0.01, kCubic);
  one_wave.waves = {true};
  EXPECT_THROW((void)refine_grid(coarse(), 2, peaked(), one_wave), std::invalid_argument);
  RefinementOptions twice = options(0.01);
  twice.candidates = {{0, 0.5, 0.5, 1}, {}};
  EXPECT_THROW((void)refine_grid(coarse(), 2, peaked(), twice), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
