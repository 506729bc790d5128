#include "emulator/cubic_interpolant.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "emulator/experiment.hpp"
#include "emulator/multilinear_interpolant.hpp"
#include "tests/emulator/allocation_count.hpp"

namespace wheeltap::emulator::cubic_interpolant_test {
namespace {

constexpr Eigen::Index kResponses = 11;  // not a multiple of the kernel's block

std::vector<Factor> uneven(std::size_t d) {
  std::vector<Factor> factors;
  for (std::size_t j = 0; j < d; ++j)
    factors.push_back({.name = std::to_string(j),
                       .unit = "",
                       .levels = {-0.3, 0.0, 0.17, 0.35, 0.6},
                       .scale = j % 2 ? Scale::compliance : Scale::linear});
  return factors;
}

using Function = void (*)(std::span<const double> x, std::span<double> y);

CubicInterpolant fit(const std::vector<Factor>& factors, Function f,
                     const std::vector<AxisRule>& rules) {
  const ModelFactory factory = [f] { return Model(f); };
  return {factors, run_experiment(full_factorial(factors), kResponses, factory), rules};
}

/// A parabola in each coordinate, with every product term; factors alternate linear, compliance.
void parabolas(std::span<const double> x, std::span<double> y) {
  for (std::size_t k = 0; k < y.size(); ++k) {
    y[k] = 1.0;
    for (std::size_t j = 0; j < x.size(); ++j) {
      const double s = j % 2 ? 1.0 / (1.0 - x[j]) : x[j];
      y[k] *= 1.0 + s * (0.2 * static_cast<double>(k) - s);
    }
  }
}

/// Increasing in every factor, with steep steps.
void steps(std::span<const double> x, std::span<double> y) {
  for (std::size_t k = 0; k < y.size(); ++k) {
    y[k] = 0.0;
    for (double xj : x) y[k] += std::tanh((4.0 + 3.0 * static_cast<double>(k)) * (xj - 0.1));
  }
}

class CubicDimension : public testing::TestWithParam<std::size_t> {};

TEST_P(CubicDimension, ExactAtNodesUnderEveryRule) {
  const auto factors = uneven(GetParam());
  const Design design = full_factorial(factors);
  std::vector<double> y(kResponses);
  for (AxisRule rule : {AxisRule::linear, AxisRule::cubic, AxisRule::monotone_cubic}) {
    const CubicInterpolant f = fit(factors, steps, std::vector(GetParam(), rule));
    for (Eigen::Index i = 0; i < design.runs(); ++i) {
      f.evaluate(design.point(i), y);
      for (Eigen::Index k = 0; k < kResponses; ++k)
        ASSERT_EQ(y[static_cast<std::size_t>(k)], f.values()(i, k));
    }
  }
}

TEST_P(CubicDimension, CubicReproducesParabolas) {
  const auto factors = uneven(GetParam());
  const CubicInterpolant f = fit(factors, parabolas, std::vector(GetParam(), AxisRule::cubic));
  const double size = f.values().cwiseAbs().maxCoeff();
  const Design points = random_design(factors, 200, 3);
  std::vector<double> y(kResponses), expected(kResponses);
  for (Eigen::Index i = 0; i < points.runs(); ++i) {
    f.evaluate(points.point(i), y);
    parabolas(points.point(i), expected);
    for (std::size_t k = 0; k < kResponses; ++k) ASSERT_NEAR(y[k], expected[k], 1e-12 * size);
  }
}

TEST_P(CubicDimension, LinearRuleIsTheMultilinearInterpolant) {
  const auto factors = uneven(GetParam());
  const CubicInterpolant f = fit(factors, steps, std::vector(GetParam(), AxisRule::linear));
  const MultilinearInterpolant g(factors, f.values());
  const Design points = random_design(factors, 100, 5);
  std::vector<double> y(kResponses), expected(kResponses);
  for (Eigen::Index i = 0; i < points.runs(); ++i) {
    f.evaluate(points.point(i), y);
    g.evaluate(points.point(i), expected);
    for (std::size_t k = 0; k < kResponses; ++k) ASSERT_NEAR(y[k], expected[k], 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(CubicInterpolant, CubicDimension, testing::Values(1, 2, 3, 4));

/// Largest decrease along lines that should increase.
double largest_fall(AxisRule rule) {
  const auto factors = uneven(2);
  const CubicInterpolant f = fit(factors, steps, {rule, rule});
  std::vector<double> y(kResponses), last(kResponses);
  double fall = 0;
  for (double level : factors[1].levels)
    for (int i = 0; i <= 600; ++i) {
      f.evaluate(std::vector{-0.3 + 0.9 * std::min(i / 600.0, 1 - 1e-9), level}, y);
      for (std::size_t k = 0; i > 0 && k < kResponses; ++k) fall = std::max(fall, last[k] - y[k]);
      last = y;
    }
  return fall;
}

TEST(CubicInterpolant, MonotoneDataGiveMonotoneLines) {
  EXPECT_LE(largest_fall(AxisRule::monotone_cubic), 1e-13);
  EXPECT_GT(largest_fall(AxisRule::cubic), 0.01) << "the control overshoots";
}

double order(AxisRule rule) {
  const auto worst = [rule](int cells) {
    Factor x{"x", "", {}};
    for (int i = 0; i <= cells; ++i) x.levels.push_back(static_cast<double>(i) / cells);
    RowMatrix values(cells + 1, 1);
    for (int i = 0; i <= cells; ++i) values(i, 0) = std::exp(x.levels[static_cast<std::size_t>(i)]);
    const CubicInterpolant f({x}, values, {rule});
    double error = 0, y = 0;
    for (int i = 0; i < 2000; ++i) {
      const double at = (i + 0.5) / 2000;
      f.evaluate({&at, 1}, {&y, 1});
      error = std::max(error, std::abs(y - std::exp(at)));
    }
    return error;
  };
  return std::log2(worst(16) / worst(32));
}

TEST(CubicInterpolant, HasItsOrdersOfConvergence) {
  EXPECT_NEAR(order(AxisRule::linear), 2.0, 0.1);
  EXPECT_NEAR(order(AxisRule::cubic), 3.0, 0.1);
  EXPECT_NEAR(order(AxisRule::monotone_cubic), 3.0, 0.1);
}

TEST(CubicInterpolant, IsLinearForTwoLevels) {
  RowMatrix values(2, 1);
  values << 1, 3;
  const CubicInterpolant f({{"x", "", {0, 1}}}, values, {AxisRule::monotone_cubic});
  const double x = 0.25;
  double y = 0;
  f.evaluate({&x, 1}, {&y, 1});
  EXPECT_DOUBLE_EQ(y, 1.5);
}

TEST(CubicInterpolant, DoesNotAllocate) {
  const CubicInterpolant f = fit(uneven(4), parabolas, std::vector(4, AxisRule::monotone_cubic));
  std::vector<double> y(kResponses);
  const std::vector x{0.1, 0.2, 0.3, 0.4};
  const long before = test::allocations();
  f.evaluate(x, y);
  EXPECT_EQ(test::allocations(), before);
}

TEST(CubicInterpolant, RejectsInvalidInput) {
  const auto factors = uneven(2);
  const CubicInterpolant f = fit(factors, steps, {AxisRule::linear, AxisRule::cubic});
  std::vector<double> y(kResponses);
  EXPECT_THROW(f.evaluate(std::vector{0.0, 0.7}, y), std::out_of_range);
  EXPECT_THROW(CubicInterpolant(factors, f.values(), {AxisRule::cubic}), std::invalid_argument);
  std::vector<Factor> many;
  for (int j = 0; j < 7; ++j) many.push_back({std::to_string(j), "", {0, 1}});
  EXPECT_THROW(CubicInterpolant(many, RowMatrix::Zero(128, 1), std::vector(7, AxisRule::cubic)),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator::cubic_interpolant_test
