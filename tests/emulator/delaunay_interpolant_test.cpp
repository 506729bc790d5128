#include "emulator/delaunay_interpolant.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/emulator/allocation_count.hpp"

namespace wheeltap::emulator {
namespace {

using Eigen::Index;

constexpr Index kResponses = 5;

/// Box of uneven ranges; the second factor works in the compliance.
std::vector<Factor> box(std::size_t d) {
  std::vector<Factor> factors;
  for (std::size_t j = 0; j < d; ++j)
    factors.push_back({.name = std::to_string(j),
                       .unit = "",
                       .levels = {0.0, j % 2 ? 0.6 : 10.0},
                       .scale = j % 2 ? Scale::compliance : Scale::linear});
  return factors;
}

/// Linear in the scale coordinates.
RowMatrix planes(const std::vector<Factor>& factors, const RowMatrix& points) {
  RowMatrix y(points.rows(), kResponses);
  for (Index i = 0; i < y.rows(); ++i)
    for (Index r = 0; r < kResponses; ++r) {
      y(i, r) = 1.0 + static_cast<double>(r);
      for (Index j = 0; j < points.cols(); ++j)
        y(i, r) += std::sin(static_cast<double>(1 + r + 3 * j)) *
                   to_scale(factors[static_cast<std::size_t>(j)].scale, points(i, j));
    }
  return y;
}

class DelaunayDimension : public testing::TestWithParam<std::size_t> {};

TEST_P(DelaunayDimension, ReproducesLinearFunctions) {
  const auto factors = box(GetParam());
  const Design design = with_corners(latin_hypercube(factors, 60, 1));
  const DelaunayInterpolant f(factors, design.points, planes(factors, design.points));
  const Design fresh = random_design(factors, 500, 2);
  const RowMatrix expected = planes(factors, fresh.points);
  std::vector<double> y(kResponses);
  for (Index i = 0; i < fresh.runs(); ++i) {
    f.evaluate(fresh.point(i), y);
    for (Index r = 0; r < kResponses; ++r)
      ASSERT_NEAR(y[static_cast<std::size_t>(r)], expected(i, r),
                  1e-12 * expected.cwiseAbs().maxCoeff());
  }
}

TEST_P(DelaunayDimension, ExactAtTheRuns) {
  const auto factors = box(GetParam());
  const Design design = with_corners(sobol(factors, 50, 3));
  std::srand(1);
  const RowMatrix values = RowMatrix::Random(design.runs(), kResponses);
  const DelaunayInterpolant f(factors, design.points, values);
  std::vector<double> y(kResponses);
  for (Index i = 0; i < design.runs(); ++i) {
    f.evaluate(design.point(i), y);
    for (Index r = 0; r < kResponses; ++r)
      ASSERT_NEAR(y[static_cast<std::size_t>(r)], values(i, r), 2 * 1e-9);
  }
}

TEST_P(DelaunayDimension, StaysBetweenTheRunsAndIsContinuous) {
  const auto factors = box(GetParam());
  const Design design = with_corners(latin_hypercube(factors, 60, 4));
  std::srand(2);
  const RowMatrix values = RowMatrix::Random(design.runs(), 1);
  const DelaunayInterpolant f(factors, design.points, values);
  // Along a line through the box, no jump exceeds the steepest simplex's slope.
  double last = 0, y = 0;
  std::vector<double> x(GetParam());
  for (int i = 0; i <= 20000; ++i) {
    for (std::size_t j = 0; j < x.size(); ++j)
      x[j] = factors[j].high() * (0.03 + 0.94 * (j % 2 ? 20000 - i : i) / 20000.0);
    f.evaluate(x, {&y, 1});
    EXPECT_LE(std::abs(y), values.cwiseAbs().maxCoeff() + 1e-12);
    if (i > 0) {
      EXPECT_LT(std::abs(y - last), 0.02) << i;
    }
    last = y;
  }
}

INSTANTIATE_TEST_SUITE_P(DelaunayInterpolant, DelaunayDimension, testing::Values(1, 2, 3, 4, 5));

TEST(DelaunayInterpolant, ErrorFallsAsTheSquareOfTheDistanceBetweenRuns) {
  const std::vector<Factor> square = {{"a", "", {0, 1}}, {"b", "", {0, 1}}};
  const auto rmse = [&](Index n) {
    const Design design = with_corners(sobol(square, n, 5));
    RowMatrix y(design.runs(), 1);
    const auto wave = [](double a, double b) { return std::sin(4 * a) * std::cos(3 * b); };
    for (Index i = 0; i < y.rows(); ++i) y(i, 0) = wave(design.points(i, 0), design.points(i, 1));
    const DelaunayInterpolant f(square, design.points, y);
    // Away from the sides of the box, where long thin triangles connect the corners.
    const Design fresh = random_design({{"a", "", {0.15, 0.85}}, {"b", "", {0.15, 0.85}}}, 2000, 6);
    double sum = 0, value = 0;
    for (Index i = 0; i < fresh.runs(); ++i) {
      f.evaluate(fresh.point(i), {&value, 1});
      sum += std::pow(value - wave(fresh.points(i, 0), fresh.points(i, 1)), 2);
    }
    return std::sqrt(sum / 2000);
  };
  // 16 times the runs, a quarter of the distance.
  EXPECT_NEAR(std::log(rmse(64) / rmse(1024)) / std::log(4.0), 2.0, 0.35);
}

TEST(DelaunayInterpolant, NamesAPointOutsideTheHull) {
  const std::vector<Factor> factors = {{"location", "m", {0, 1}}, {"reduction", "", {0, 1}}};
  RowMatrix triangle(3, 2), values(3, 1);
  triangle << 0, 0, 1, 0, 0, 1;
  values << 1, 2, 3;
  const DelaunayInterpolant f(factors, triangle, values);
  double y = 0;
  f.evaluate(std::vector{0.25, 0.5}, {&y, 1});
  EXPECT_NEAR(y, 1 + 0.25 + 1.0, 1e-15);
  f.evaluate(std::vector{0.5, 0.5}, {&y, 1});
  EXPECT_NEAR(y, 2.5, 1e-15) << "on the hull";
  EXPECT_TRUE(f.contains(std::vector{0.5, 0.5}));
  for (const std::vector<double>& x :
       {std::vector{0.75, 0.5}, std::vector{0.5, -0.1}, std::vector{0.2, std::nan("")}}) {
    EXPECT_FALSE(f.contains(x));
    EXPECT_THROW(f.evaluate(x, {&y, 1}), std::out_of_range);
  }
  try {
    f.evaluate(std::vector{0.75, 0.5}, {&y, 1});
  } catch (const std::out_of_range& error) {
    EXPECT_NE(std::string(error.what()).find("location = 0.75, reduction = 0.5"),
              std::string::npos);
  }
}

TEST(DelaunayInterpolant, LookupsDoNotAllocate) {
  const auto factors = box(4);
  const Design design = with_corners(latin_hypercube(factors, 60, 7));
  const DelaunayInterpolant f(factors, design.points, planes(factors, design.points));
  std::vector<double> y(kResponses);
  const std::vector x{1.0, 0.2, 3.0, 0.4};
  const long before = test::allocations();
  f.evaluate(x, y);
  EXPECT_EQ(test::allocations(), before);
}

TEST(DelaunayInterpolant, RejectsRunsThatCannotBeTriangulated) {
  const std::vector<Factor> factors = {{"a", "", {0, 1}}, {"b", "", {0, 1}}};
  const auto refused = [&](const RowMatrix& points) {
    try {
      const DelaunayInterpolant f(factors, points, RowMatrix::Ones(points.rows(), 1));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  RowMatrix line(5, 2);
  line << 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1;
  EXPECT_NE(refused(line).find("hyperplane"), std::string::npos);
  RowMatrix twice(4, 2);
  twice << 0, 0, 1, 0, 0, 1, 1, 0;
  EXPECT_NE(refused(twice).find("twice"), std::string::npos);
  RowMatrix outside(4, 2);
  outside << 0, 0, 1, 0, 0, 1, 1.5, 0;
  EXPECT_NE(refused(outside).find("outside"), std::string::npos);
  EXPECT_NE(refused(RowMatrix::Random(2, 2)).find("at least 3"), std::string::npos);
  const RowMatrix grid = full_factorial({{"a", "", {0, 0.5, 1}}, {"b", "", {0, 1}}}).points;
  EXPECT_NE(refused(grid).find("grid"), std::string::npos);
  const std::vector<Factor> six = box(6);
  EXPECT_THROW(DelaunayInterpolant(six, random_design(six, 20, 1).points, RowMatrix::Ones(20, 1)),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
