#include "emulator/multilinear_interpolant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "emulator/holdout.hpp"
#include "tests/emulator/allocation_count.hpp"

namespace wheeltap::emulator {
namespace {

constexpr Eigen::Index kOutputs = 21;  // not a multiple of the kernel's block

/// Uneven levels on d axes; every second axis works in the compliance.
std::vector<Factor> uneven(std::size_t d) {
  std::vector<Factor> factors;
  for (std::size_t j = 0; j < d; ++j)
    factors.push_back({.name = std::string("x") + std::to_string(j),
                       .unit = "",
                       .levels = {-0.3, 0.0, 0.17, 0.6},
                       .scale = j % 2 ? Scale::compliance : Scale::linear});
  for (std::size_t j = 3; j < d; ++j) factors[j].levels = {0.1, 0.4};
  return factors;
}

/// Linear in each factor's coordinate separately, with every product term.
void multilinear(const std::vector<Factor>& factors, std::span<const double> x,
                 std::span<double> y) {
  for (std::size_t k = 0; k < y.size(); ++k) {
    double product = 1.0;
    for (std::size_t j = 0; j < x.size(); ++j)
      product *= 1.0 + (0.3 + 0.1 * static_cast<double>(j + k)) * to_scale(factors[j].scale, x[j]);
    y[k] = product - static_cast<double>(k);
  }
}

MultilinearInterpolant table(const std::vector<Factor>& factors) {
  const Design design = full_factorial(factors);
  const ModelFactory factory = [&] {
    return [&](std::span<const double> x, std::span<double> y) { multilinear(factors, x, y); };
  };
  return {factors, run_experiment(design, kOutputs, factory)};
}

class Dimension : public testing::TestWithParam<std::size_t> {};

TEST_P(Dimension, ExactAtEveryNode) {
  const auto factors = uneven(GetParam());
  const MultilinearInterpolant f = table(factors);
  const Design design = full_factorial(factors);
  std::vector<double> y(kOutputs);
  for (Eigen::Index i = 0; i < design.runs(); ++i) {
    f.evaluate(design.point(i), y);
    for (Eigen::Index k = 0; k < kOutputs; ++k)
      ASSERT_EQ(y[static_cast<std::size_t>(k)], f.values()(i, k));
  }
}

TEST_P(Dimension, ReproducesMultilinearFunctions) {
  const auto factors = uneven(GetParam());
  const MultilinearInterpolant f = table(factors);
  const Design points = random_design(factors, 300, 11);
  const double scale = f.values().cwiseAbs().maxCoeff();
  std::vector<double> y(kOutputs), expected(kOutputs);
  for (Eigen::Index i = 0; i < points.runs(); ++i) {
    f.evaluate(points.point(i), y);
    multilinear(factors, points.point(i), expected);
    for (std::size_t k = 0; k < kOutputs; ++k) ASSERT_NEAR(y[k], expected[k], 1e-12 * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(MultilinearInterpolant, Dimension, testing::Values(1, 2, 3, 4, 6));

TEST(MultilinearInterpolant, ErrorFallsAsTheSquareOfTheSpacing) {
  const auto worst = [](int cells) {
    Factor x{"x", "", {}};
    for (int i = 0; i <= cells; ++i) x.levels.push_back(static_cast<double>(i) / cells);
    RowMatrix values(cells + 1, 1);
    for (int i = 0; i <= cells; ++i) values(i, 0) = std::exp(x.levels[static_cast<std::size_t>(i)]);
    const MultilinearInterpolant f({x}, values);
    double error = 0, y = 0;
    for (int i = 0; i < 1000; ++i) {
      const double at = (i + 0.5) / 1000;
      f.evaluate({&at, 1}, {&y, 1});
      error = std::max(error, std::abs(y - std::exp(at)));
    }
    return error;
  };
  EXPECT_NEAR(std::log2(worst(8) / worst(16)), 2.0, 0.1);
}

TEST(MultilinearInterpolant, NamesTheFactorOutsideTheBox) {
  const MultilinearInterpolant f = table(uneven(2));
  std::vector<double> y(kOutputs);
  for (double outside : {-0.3000001, 0.6000001, std::nan(""), HUGE_VAL}) {
    const std::vector x{0.0, outside};
    EXPECT_FALSE(f.contains(x));
    try {
      f.evaluate(x, y);
      FAIL() << outside;
    } catch (const std::out_of_range& error) {
      EXPECT_NE(std::string(error.what()).find("\"x1\""), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("[-0.3, 0.6]"), std::string::npos);
    }
  }
  EXPECT_TRUE(f.contains(std::vector{0.6, -0.3}));
  EXPECT_THROW(f.evaluate(std::vector{0.0}, y), std::invalid_argument);
  y.pop_back();
  EXPECT_THROW(f.evaluate(std::vector{0.0, 0.0}, y), std::invalid_argument);
}

TEST(MultilinearInterpolant, RejectsInvalidTables) {
  const std::vector<Factor> line = {{"x", "", {0, 1, 2}}};
  EXPECT_THROW(MultilinearInterpolant(line, RowMatrix::Zero(2, 1)), std::invalid_argument);
  EXPECT_THROW(MultilinearInterpolant(line, RowMatrix(3, 0)), std::invalid_argument);
  RowMatrix values = RowMatrix::Zero(3, 1);
  values(1, 0) = std::nan("");
  EXPECT_THROW(MultilinearInterpolant(line, values), std::invalid_argument);
  EXPECT_THROW(MultilinearInterpolant({{"x", "", {0}}}, RowMatrix::Zero(1, 1)),
               std::invalid_argument);
}

TEST(MultilinearInterpolant, EvaluationDoesNotAllocate) {
  const MultilinearInterpolant f = table(uneven(4));
  std::vector<double> y(kOutputs);
  const std::vector x{0.1, 0.2, 0.3, 0.2};
  const long before = test::allocations();
  for (int i = 0; i < 100; ++i) f.evaluate(x, y);
  EXPECT_EQ(test::allocations(), before);
  const auto control = std::make_unique<std::vector<double>>(y);
  EXPECT_EQ(test::allocations(), before + 2) << "the counter must count";
}

}  // namespace
}  // namespace wheeltap::emulator
