#include "identification/modal/real_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "identification/structural/likelihood/shape_density.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

VectorXcd nearly_real() {
  VectorXcd shape(4);
  shape << std::complex(0.3, 0.02), std::complex(-0.7, 0.01), std::complex(1.0, 0.0),
      std::complex(0.5, -0.03);
  return shape;
}

MatrixXd some_covariance(int size) {
  MatrixXd root(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) root(i, j) = 1e-3 * std::sin(1.0 + 3.0 * i + 7.0 * j + i * j);
  return root * root.transpose() + 1e-7 * MatrixXd::Identity(size, size);
}

// A complex factor does not change the real shape and its covariance on the tangent plane.
TEST(RealShape, DoesNotDependOnTheComplexFactor) {
  const VectorXcd shape = nearly_real();
  const MatrixXd c = some_covariance(8);
  const RealShape plain = real_shape(shape, c, 0);
  const std::complex<double> factor = std::polar(3.0, 1.1);
  MatrixXd turn(8, 8);
  turn << factor.real() * MatrixXd::Identity(4, 4), -factor.imag() * MatrixXd::Identity(4, 4),
      factor.imag() * MatrixXd::Identity(4, 4), factor.real() * MatrixXd::Identity(4, 4);
  const RealShape turned = real_shape(factor * shape, turn * c * turn.transpose(), 0);
  const double sign = plain.values.dot(turned.values) > 0.0 ? 1.0 : -1.0;
  EXPECT_LT((plain.values - sign * turned.values).norm(), 1e-12);
  EXPECT_LT((plain.covariance - turned.covariance).norm(), 1e-12 * plain.covariance.norm());
  EXPECT_NEAR(plain.values.cwiseAbs().maxCoeff(), 1.0, 1e-15);
}

// Compares the covariance with the scatter of draws of the complex shape.
TEST(RealShape, CovarianceIsThatOfScatter) {
  VectorXcd shape = nearly_real();
  shape.imag() << 0.4, 0.3, 0.0, -0.5;
  const MatrixXd c = some_covariance(8);
  const RealShape found = real_shape(shape, c, 0);
  const VectorXd along = found.values.normalized();
  const MatrixXd root = c.llt().matrixL();
  base::Random random(1, 0, 0, base::Purpose::simulation);
  constexpr int kDraws = 40000;
  MatrixXd sum = MatrixXd::Zero(4, 4);
  for (int i = 0; i < kDraws; ++i) {
    VectorXd z(8);
    for (double& x : z) x = random.normal();
    const VectorXd e = 0.1 * root * z;
    VectorXcd moved = shape;
    moved.real() += e.head(4);
    moved.imag() += e.tail(4);
    VectorXd y = real_shape(moved, c, 0).values;
    y *= found.values.norm() / y.norm() * (y.dot(along) > 0.0 ? 1.0 : -1.0);
    const VectorXd d = 10.0 * (y - found.values);
    sum += d * d.transpose() / kDraws;
  }
  const MatrixXd across = MatrixXd::Identity(4, 4) - along * along.transpose();
  const MatrixXd expected = across * found.covariance * across;
  // The relative error of a variance is √(2/n), 0.7 %.
  EXPECT_LT((across * sum * across - expected).norm(), 0.03 * expected.norm());
}

// A shape scaled to make one entry 1 has no scatter there; its density exists.
TEST(RealShape, AnEntryScaledToOneHasNoVariance) {
  MatrixXd c = some_covariance(8);
  for (const int tied : {2, 6}) {
    c.row(tied).setZero();
    c.col(tied).setZero();
  }
  const RealShape found = real_shape(nearly_real(), c, 0);
  const ShapeDensity density(found.values, found.covariance);
  EXPECT_NEAR(density.against(found.values).chi_square, 0.0, 1e-9);
}

TEST(RealShape, RaisesEstimatedCovariancesAndDropsCorrelationsForFewBlocks) {
  const MatrixXd c = some_covariance(8);
  const RealShape exact = real_shape(nearly_real(), c, 0);
  const RealShape estimated = real_shape(nearly_real(), c, 50);
  EXPECT_NEAR(estimated.covariance(0, 1) / exact.covariance(0, 1),
              49.0 / 45.0 * (1.0 + 2.0 * 45.0 / (46.0 * 43.0)), 1e-12);
  const RealShape few = real_shape(nearly_real(), c, 8);
  EXPECT_FALSE(few.correlated);
  EXPECT_EQ(few.covariance(0, 1), 0.0);
}

TEST(RealShape, RejectsInvalidInput) {
  const VectorXcd shape = nearly_real();
  EXPECT_THROW((void)real_shape(shape.head(1), some_covariance(2), 0), std::invalid_argument);
  EXPECT_THROW((void)real_shape(shape, some_covariance(4), 0), std::invalid_argument);
  EXPECT_THROW((void)real_shape(VectorXcd::Zero(4), some_covariance(8), 0), std::invalid_argument);
  EXPECT_THROW((void)real_shape(shape, MatrixXd::Zero(8, 8), 0), std::invalid_argument);
}

// GLS with the raised estimated covariance: the stated variance is that of its scatter.
TEST(RealShape, RaisedCovariancesStateTheScatterOfEstimates) {
  constexpr int kNumbers = 11, kBlocks = 50, kDraws = 4000;
  base::Random random(2, 0, 0, base::Purpose::test);
  const auto normal = [&](Eigen::Index rows, Eigen::Index columns) {
    MatrixXd out(rows, columns);
    for (double& v : out.reshaped()) v = random.normal();
    return out;
  };
  const VectorXd one = VectorXd::Ones(kNumbers);
  double errors = 0.0, stated = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const MatrixXd x = normal(kNumbers, kBlocks);
    const MatrixXd centred = x.colwise() - x.rowwise().mean();
    const MatrixXd c = estimated_covariance_factor(kNumbers, kBlocks) * centred *
                       centred.transpose() / (kBlocks - 1.0);
    const VectorXd weights = c.ldlt().solve(one);
    const double estimate = weights.dot(normal(kNumbers, 1).col(0)) / weights.sum();
    errors += estimate * estimate / kDraws;
    stated += 1.0 / weights.sum() / kDraws;
  }
  // χ² of 4000 has a scatter of 2.2 %; the correction is of first order.
  EXPECT_NEAR(errors / stated, 1.0, 0.1);
  EXPECT_EQ(estimated_covariance_factor(kNumbers, 2 * kNumbers + 2), 0.0);
  EXPECT_NEAR(estimated_covariance_factor(1, 5), 2.0, 1e-15);
}

}  // namespace
}  // namespace wheeltap::identification
