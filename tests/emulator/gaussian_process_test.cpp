#include "emulator/gaussian_process.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "base/eigen_solvers.hpp"
#include "emulator/holdout.hpp"

namespace wheeltap::emulator {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<Factor> cube(std::size_t d) {
  std::vector<Factor> factors;
  for (std::size_t j = 0; j < d; ++j) factors.push_back({std::to_string(j), "", {0, 1}});
  return factors;
}

double k(Kernel kernel, double squared) {
  if (kernel == Kernel::squared_exponential) return std::exp(-squared / 2);
  const double r = std::sqrt(5 * squared);
  return (1 + r + r * r / 3) * std::exp(-r);
}

/// R by its definition.
MatrixXd correlation_matrix(const RowMatrix& u, const Correlation& c) {
  MatrixXd r(u.rows(), u.rows());
  for (Index i = 0; i < u.rows(); ++i)
    for (Index j = 0; j < u.rows(); ++j)
      r(i, j) =
          k(c.kernel, (u.row(i) - u.row(j)).transpose().cwiseQuotient(c.lengths).squaredNorm()) +
          (i == j ? c.nugget : 0.0);
  return r;
}

double smooth_surface(double a, double b, double wave) {
  return std::sin(wave * a) * std::exp(b) + 10.0;
}

RowMatrix smooth_values(const RowMatrix& points, Index responses) {
  RowMatrix y(points.rows(), responses);
  for (Index i = 0; i < y.rows(); ++i)
    for (Index r = 0; r < responses; ++r)
      y(i, r) = smooth_surface(points(i, 0), points(i, 1), 2.0 + static_cast<double>(r));
  return y;
}

class GaussianProcessKernel : public testing::TestWithParam<Kernel> {};

TEST_P(GaussianProcessKernel, LikelihoodMatchesItsDefinition) {
  const RowMatrix u = random_design(cube(2), 15, 1).points;
  const RowMatrix y = smooth_values(u, 2);
  const Correlation c{GetParam(), Eigen::Vector2d(0.3, 0.7), 1e-3};
  const MatrixXd r = correlation_matrix(u, c);
  const VectorXd ones = VectorXd::Ones(15);
  const double mean_weight = ones.dot(r.fullPivLu().solve(ones));
  double expected = 0;
  for (Index column = 0; column < 2; ++column) {
    const VectorXd v = y.col(column);
    const double beta = ones.dot(r.fullPivLu().solve(v)) / mean_weight;
    const VectorXd e = v.array() - beta;
    const double variance = e.dot(r.fullPivLu().solve(e)) / 15;
    expected -=
        0.5 * (15 * std::log(2 * std::numbers::pi * variance) + std::log(r.determinant()) + 15);
  }
  EXPECT_NEAR(log_marginal_likelihood(u, y, c).value, expected, 1e-8);
}

TEST_P(GaussianProcessKernel, GradientMatchesFiniteDifferences) {
  const RowMatrix u = random_design(cube(3), 30, 2).points;
  const RowMatrix y = smooth_values(u, 2);
  const Correlation c{GetParam(), Eigen::Vector3d(0.3, 0.5, 0.9), 1e-3};
  const VectorXd gradient = log_marginal_likelihood(u, y, c).gradient;
  for (Index p = 0; p < 4; ++p) {
    const auto shifted = [&](double by) {
      Correlation moved = c;
      (p < 3 ? moved.lengths(p) : moved.nugget) *= std::exp(by);
      return log_marginal_likelihood(u, y, moved).value;
    };
    // Fourth-order differences: error about h⁴ and rounding 1e-13 · |ln L| · cond / h.
    const double h = 1e-3;
    const double expected =
        (8 * (shifted(h) - shifted(-h)) - (shifted(2 * h) - shifted(-2 * h))) / (12 * h);
    EXPECT_NEAR(gradient(p), expected, 1e-6 * gradient.norm()) << "parameter " << p;
  }
}

TEST_P(GaussianProcessKernel, InterpolatesNoiseFreeRuns) {
  const Design design = latin_hypercube(cube(2), 50, 3);
  const RowMatrix y = smooth_values(design.points, 3);
  const GaussianProcess f(design.factors, design.points, y, {.kernel = GetParam()});
  std::vector<double> mean(3), variance(3);
  for (Index i = 0; i < design.runs(); ++i) {
    f.evaluate(design.point(i), mean, variance);
    for (Index r = 0; r < 3; ++r) {
      const double spread = std::sqrt((y.col(r).array() - y.col(r).mean()).square().mean());
      // A nugget η leaves about √η of the spread: 1e-6 (Matérn) and 1e-4.
      const double left = GetParam() == Kernel::squared_exponential ? 5e-4 : 1e-5;
      EXPECT_NEAR(mean[static_cast<std::size_t>(r)], y(i, r), left * spread);
      EXPECT_LT(variance[static_cast<std::size_t>(r)], 1e-6 * spread * spread);
    }
  }
}

TEST_P(GaussianProcessKernel, PredictsASmoothFunction) {
  const Design design = latin_hypercube(cube(2), 60, 4);
  const GaussianProcess f(design.factors, design.points, smooth_values(design.points, 3),
                          {.kernel = GetParam()});
  const Design fresh = random_design(cube(2), 300, 5);
  const auto errors = holdout_error(
      smooth_values(fresh.points, 3),
      predict([&](std::span<const double> x, std::span<double> y) { f.evaluate(x, y); }, fresh, 3));
  for (const HoldoutError& e : errors) EXPECT_GT(e.q2, 0.9999);
}

/// Ordinary Kriging of one run from the others by its textbook system with a Lagrange multiplier.
TEST_P(GaussianProcessKernel, LeaveOneOutMatchesBruteForce) {
  const Index n = 40;
  const Design design = latin_hypercube(cube(2), n, 6);
  const RowMatrix y = smooth_values(design.points, 2);
  RowMatrix parameters(1, 3);
  parameters << 0.25, 0.6, 1e-5;
  const GaussianProcess f(design.factors, design.points, y, GetParam(), parameters);
  const LeaveOneOut loo = f.leave_one_out();
  const Correlation c{GetParam(), Eigen::Vector2d(0.25, 0.6), 1e-5};
  const MatrixXd r = correlation_matrix(design.points, c);
  const VectorXd ones = VectorXd::Ones(n);
  for (Index response = 0; response < 2; ++response) {
    const VectorXd v = y.col(response);
    const auto lu = r.fullPivLu();
    const VectorXd e = v.array() - ones.dot(lu.solve(v)) / ones.dot(lu.solve(ones));
    const double variance = e.dot(lu.solve(e)) / static_cast<double>(n);
    for (Index i = 0; i < n; ++i) {
      std::vector<Index> others;
      for (Index j = 0; j < n; ++j)
        if (j != i) others.push_back(j);
      MatrixXd system = MatrixXd::Zero(n, n);
      system.topLeftCorner(n - 1, n - 1) = r(others, others);
      system.rightCols<1>().head(n - 1).setOnes();
      system.bottomRows<1>().head(n - 1).setOnes();
      VectorXd right(n);
      right << VectorXd(r(others, i)), 1.0;
      const VectorXd weights = system.fullPivLu().solve(right);
      const double mean = weights.head(n - 1).dot(VectorXd(v(others)));
      const double own = variance * (1.0 + c.nugget - weights.dot(right));
      EXPECT_NEAR(loo.mean(i, response), mean, 1e-8 * std::abs(mean));
      EXPECT_NEAR(loo.variance(i, response), own, 1e-8 * variance);
    }
  }
}

TEST_P(GaussianProcessKernel, StaysPositiveDefiniteForAThousandClusteredPoints) {
  const Index n = 1000;
  const RowMatrix centres = latin_hypercube(cube(2), 10, 7).points;
  RowMatrix points(n, 2);
  std::mt19937_64 generator(8);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < 2; ++j)
      points(i, j) = std::clamp(
          centres(i % 10, j) + 1e-7 * static_cast<double>(generator() >> 11) * 0x1p-53, 0.0, 1.0);
  points.row(999) = points.row(9);  // with one duplicate
  const RowMatrix y = smooth_values(points, 1);
  const GaussianProcess f(cube(2), points, y, {.kernel = GetParam(), .most_fitted_runs = 150});
  EXPECT_LE(f.parameters()(0, 2), 1e-8) << "a nugget no larger than rounding needs";
  double mean = 0, variance = 0;
  for (Index i = 0; i < n; i += 37) {
    f.evaluate(std::span(points.row(i).data(), 2), {&mean, 1}, {&variance, 1});
    EXPECT_NEAR(mean, y(i, 0), 1e-4);
    EXPECT_GE(variance, 0.0);
  }
  const LeaveOneOut loo = f.leave_one_out();
  EXPECT_TRUE(loo.mean.allFinite());
  EXPECT_TRUE((loo.variance.array() > 0).all());
}

TEST_P(GaussianProcessKernel, VarianceIsCalibratedForDrawsOfTheProcess) {
  // 400 functions drawn from the process with known lengths, each known at 40 points.
  const Index n = 41, functions = 400;
  const RowMatrix points = latin_hypercube(cube(2), n, 9).points;
  const Correlation c{GetParam(), Eigen::Vector2d(0.2, 0.4), 1e-10};
  const MatrixXd root = correlation_matrix(points, c).llt().matrixL();
  std::mt19937_64 generator(10);
  std::normal_distribution<double> normal;
  MatrixXd white(n, functions);
  for (double& w : white.reshaped()) w = normal(generator);
  const RowMatrix y = 3.0 * root * white;
  RowMatrix parameters(1, 3);
  parameters << 0.2, 0.4, 1e-10;
  const GaussianProcess f(cube(2), points.topRows(n - 1), y.topRows(n - 1), GetParam(), parameters);
  std::vector<double> mean(functions), variance(functions);
  f.evaluate(std::span(points.row(n - 1).data(), 2), mean, variance);
  double sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(functions); ++i) {
    const double z = (y(n - 1, static_cast<Index>(i)) - mean[i]) / std::sqrt(variance[i]);
    sum += z * z;
  }
  // With σ² from 40 runs z is √(40/39) times Student's t₃₉: E z² = 40/37, Var z² ≈ 2 (1 + 8/37).
  EXPECT_NEAR(sum / functions, 40.0 / 37.0, 4.5 * std::sqrt(2.5 / functions));
}

INSTANTIATE_TEST_SUITE_P(GaussianProcess, GaussianProcessKernel,
                         testing::Values(Kernel::matern52, Kernel::squared_exponential),
                         [](const auto& param) {
                           return param.param == Kernel::matern52 ? "Matern" : "SquaredExponential";
                         });

TEST(GaussianProcess, AFactorWithoutEffectGetsALongLength) {
  const Design design = latin_hypercube(cube(3), 60, 11);
  const GaussianProcess f(design.factors, design.points, smooth_values(design.points, 1));
  const RowMatrix p = f.parameters();
  EXPECT_GT(p(0, 2), 5 * p(0, 0));
}

TEST(GaussianProcess, EstimatesTheNoiseOfTheRuns) {
  const Design design = latin_hypercube(cube(2), 300, 12);
  RowMatrix y = smooth_values(design.points, 1);
  std::mt19937_64 generator(13);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (Index i = 0; i < y.rows(); ++i) y(i, 0) += noise(generator);
  const GaussianProcess f(design.factors, design.points, y, {.infer_nugget = true});
  const LeaveOneOut loo = f.leave_one_out();
  const auto z = ((y - loo.mean).array() / loo.variance.array().sqrt()).eval();
  EXPECT_NEAR(z.square().mean(), 1.0, 5 * std::sqrt(2.0 / 300));
  // The variance of a left-out run is little more than its noise.
  EXPECT_NEAR(std::sqrt(loo.variance.mean()), 0.05, 5 * 0.05 / std::sqrt(2.0 * 300) + 0.003);
  double mean = 0, variance = 0;
  const std::vector x{0.5, 0.5};
  f.evaluate(x, {&mean, 1}, {&variance, 1});
  EXPECT_NEAR(mean, smooth_surface(0.5, 0.5, 2.0), 5 * std::sqrt(variance));
  EXPECT_LT(variance, 0.05 * 0.05 / 4) << "the noise averages out";
}

TEST(GaussianProcess, UsesTheScalesOfFactors) {
  // Linear in the compliance: a straight line in that scale, which Kriging reproduces to rounding;
  // a hyperbola in the reduction.
  std::vector<Factor> plain = {{"r", "", {0, 0.9}}};
  std::vector<Factor> scaled = plain;
  scaled[0].scale = Scale::compliance;
  RowMatrix points(6, 1), y(6, 1);
  points << 0, 0.3, 0.5, 0.7, 0.8, 0.9;
  for (Index i = 0; i < 6; ++i) y(i, 0) = 1 / (1 - points(i, 0));
  const auto error = [&](const std::vector<Factor>& factors) {
    const GaussianProcess f(factors, points, y);
    const double x = 0.6;
    double mean = 0;
    f.evaluate({&x, 1}, {&mean, 1});
    return std::abs(mean - 2.5);
  };
  EXPECT_LT(error(scaled), 0.1 * error(plain));
}

TEST(GaussianProcess, StoredParametersGiveTheSameProcess) {
  const Design design = latin_hypercube(cube(2), 40, 14);
  const RowMatrix y = smooth_values(design.points, 4);
  for (bool shared : {false, true}) {
    const GaussianProcess f(design.factors, design.points, y,
                            {.shared_lengths = shared, .threads = 2});
    EXPECT_EQ(f.parameters().rows(), shared ? 1 : 4);
    const GaussianProcess again(design.factors, design.points, y, f.kernel(), f.parameters());
    const GaussianProcess one_thread(design.factors, design.points, y, {.shared_lengths = shared});
    EXPECT_EQ(one_thread.parameters(), f.parameters());
    std::vector<double> a(4), b(4), va(4), vb(4);
    const std::vector x{0.3, 0.8};
    f.evaluate(x, a, va);
    again.evaluate(x, b, vb);
    EXPECT_EQ(a, b);
    EXPECT_EQ(va, vb);
    f.evaluate(x, b);
    EXPECT_EQ(a, b);
  }
}

TEST(GaussianProcess, AConstantResponseStaysConstant) {
  const Design design = latin_hypercube(cube(2), 20, 15);
  RowMatrix y = smooth_values(design.points, 2);
  y.col(1).setConstant(7.25);
  for (bool shared : {false, true}) {
    const GaussianProcess f(design.factors, design.points, y, {.shared_lengths = shared});
    std::vector<double> mean(2), variance(2);
    f.evaluate(std::vector{0.2, 0.9}, mean, variance);
    EXPECT_EQ(mean[1], 7.25);
    EXPECT_EQ(variance[1], 0.0);
    EXPECT_NEAR(mean[0], smooth_surface(0.2, 0.9, 2.0), 0.1);
  }
}

TEST(GaussianProcess, RejectsInvalidInput) {
  const Design design = latin_hypercube(cube(2), 20, 16);
  const RowMatrix y = smooth_values(design.points, 2);
  const GaussianProcess f(design.factors, design.points, y);
  std::vector<double> mean(2);
  EXPECT_THROW(f.evaluate(std::vector{0.2, 1.1}, mean), std::out_of_range);
  EXPECT_THROW(f.evaluate(std::vector{0.2, std::nan("")}, mean), std::out_of_range);
  mean.pop_back();
  EXPECT_THROW(f.evaluate(std::vector{0.2, 0.1}, mean), std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(2), design.points.topRows(1), y.topRows(1)),
               std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(2), design.points, y.topRows(19)), std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(3), design.points, y), std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(2), 2 * design.points, y), std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(2), design.points, std::nan("") * y), std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(2), design.points, y, Kernel::matern52, RowMatrix::Ones(1, 2)),
               std::invalid_argument);
  EXPECT_THROW(GaussianProcess(cube(2), design.points, y, Kernel::matern52, RowMatrix::Zero(1, 3)),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
