#include "identification/structural/likelihood/shape_density.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd vector(std::initializer_list<double> list) {
  return Eigen::Map<const VectorXd>(list.begin(), static_cast<Eigen::Index>(list.size()));
}

MatrixXd isotropic(Eigen::Index m, double sd) {
  return sd * sd * MatrixXd::Identity(m, m);
}

TEST(ShapeDensity, ScaleAndSignOfEitherShapeDoNotMatter) {
  const VectorXd measured = vector({0.4, 1.0, -0.3, 0.7}),
                 computed = vector({0.41, 1.0, -0.28, 0.66});
  const double reference = ShapeDensity(measured, isotropic(4, 0.02)).against(computed).log_density;
  for (const double scale : {-1.0, 3.0, -250.0, 1e-6}) {
    EXPECT_NEAR(ShapeDensity(scale * measured, isotropic(4, 0.02)).against(computed).log_density,
                reference, 1e-9);
    EXPECT_NEAR(ShapeDensity(measured, isotropic(4, 0.02)).against(scale * computed).log_density,
                reference, 1e-9);
  }
}

// For two entries, the density integrates to 1 over half the circle of directions.
TEST(ShapeDensity, IntegratesToOneOverTheDirectionsOfTwoEntries) {
  MatrixXd correlated(2, 2);
  correlated << 0.0009, 0.0004, 0.0004, 0.0004;
  // First order in the noise (sd 3 % of the shape's size): the next term is its square, .0009,
  // times a curvature of a few.
  for (const MatrixXd& sigma : {isotropic(2, 0.03), correlated}) {
    const VectorXd computed = vector({0.6, 0.8});
    double sum = 0.0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const double angle = kPi * (i + 0.5) / steps;
      // The density is on the tangent plane of the vector scaled to a largest entry of 1: arc
      // length is angle times its size.
      const VectorXd measured = vector({std::cos(angle), std::sin(angle)});
      const double size = 1.0 / measured.cwiseAbs().maxCoeff();
      sum += std::exp(ShapeDensity(measured, sigma).against(computed).log_density) * size * kPi /
             steps;
    }
    EXPECT_NEAR(sum, 1.0, 0.01);
  }
}

TEST(ShapeDensity, ManySamplesHaveChiSquareOfOneFewerThanEntries) {
  base::Random random(3, 0, 0, base::Purpose::test);
  const VectorXd computed = vector({0.3, 0.9, 1.0, -0.5, 0.2});
  double sum = 0.0, squares = 0.0;
  constexpr int kSamples = 20000;
  for (int s = 0; s < kSamples; ++s) {
    VectorXd measured = computed;
    for (double& x : measured) x += 0.01 * random.normal();
    const double chi_square =
        ShapeDensity(measured, isotropic(5, 0.01)).against(computed).chi_square;
    sum += chi_square / kSamples;
    squares += chi_square * chi_square / kSamples;
  }
  // χ² of 4 degrees of freedom: mean 4, variance 8; standard error of the mean 0.02. Scaling the
  // largest entry to 1 scales the noise by 1 %.
  EXPECT_NEAR(sum, 4.0, 5.0 * 0.02 + 0.04);
  EXPECT_NEAR(squares - sum * sum, 8.0, 0.6);
}

// For entries divided by one of them, the ratios are the measured values.
TEST(ShapeDensity, AnEntryScaledToOneLeavesRatios) {
  MatrixXd sigma = isotropic(3, 0.02);
  sigma(1, 1) = 0.0;
  const VectorXd measured = vector({0.4, 1.0, -0.3}), computed = vector({0.82, 2.0, -0.64});
  const auto found = ShapeDensity(measured, sigma).against(computed);
  const double a = (0.4 - 0.41) / 0.02, b = (-0.3 + 0.32) / 0.02;
  EXPECT_NEAR(found.chi_square, a * a + b * b, 1e-4);
  EXPECT_EQ(ShapeDensity(measured, sigma).freedoms(), 2);
}

TEST(ShapeDensity, AnUnknownScatterScalesTheStatedOne) {
  const VectorXd measured = vector({0.4, 1.0, -0.3, 0.7}), computed = vector({0.5, 1.0, -0.2, 0.6});
  const double direct = ShapeDensity(measured, isotropic(4, 0.05)).against(computed).log_density;
  const ShapeDensity unit(measured, isotropic(4, 1.0));
  EXPECT_NEAR(unit.against(computed, 0.05 * 0.05).log_density, direct, 1e-10);
  // The model error adds to it.
  EXPECT_NEAR(unit.against(computed, 0.03 * 0.03, 0.04 * 0.04).log_density, direct, 1e-10);
}

TEST(ShapeDensity, WithoutRotationACloseModeChangesNothing) {
  const VectorXd first = vector({0.41, 1.01, -0.3, 0.68}), second = vector({1.0, -0.2, 0.3, -0.6}),
                 noise = vector({-1.0, -1.0, 0.5, 2.0});
  // The same noise in units of its sd, decreasing: the difference is of first order in it, because
  // the scatter of the angle changes with the angle.
  std::vector<double> differences;
  for (const double sd : {0.02, 0.01, 0.005}) {
    const ShapeDensity density(first + sd * noise, isotropic(4, sd));
    differences.push_back(std::abs(density.against(first, second, 1e-9, 1.0, 0.0).log_density -
                                   density.against(first).log_density));
  }
  EXPECT_LT(differences[0], 0.05);
  for (std::size_t i = 1; i < differences.size(); ++i)
    EXPECT_NEAR(differences[i - 1] / differences[i], 2.0, 0.1) << i;
}

TEST(ShapeDensity, AShapeThatNeitherModeExplainsHasNoRotation) {
  // Orthogonal to both modes; the close mode does not move the sensors.
  const VectorXd measured = vector({0.0, 0.0, 1.0, 0.5}), first = vector({1.0, 0.5, 0.0, 0.0}),
                 second = vector({0.3, -1.0, 0.0, 0.0}), still = VectorXd::Zero(4);
  const ShapeDensity density(measured, isotropic(4, 0.01));
  const auto lost = density.against(first, second, 0.3, 1.0, 0.0);
  EXPECT_NEAR(lost.log_density, density.against(first).log_density, 1e-9);
  EXPECT_EQ(lost.turn, 0.0);
  EXPECT_EQ(density.against(first, still, 0.3, 1.0, 0.0).log_density,
            density.against(first).log_density);
}

// Any two modes of the plane of twins are equivalent and give the same density.
TEST(ShapeDensity, TwinsAreComparedByTheirPlane) {
  const VectorXd measured = vector({0.4, 1.0, -0.3, 0.7}), first = vector({0.41, 1.01, -0.3, 0.68}),
                 second = vector({1.0, -0.2, 0.3, -0.6});
  const ShapeDensity density(measured, isotropic(4, 0.01));
  const double reference = density.against(first, second, 50.0, 1.0, 0.0).log_density;
  for (const double angle : {0.3, 0.8, 1.5, 2.2}) {
    const VectorXd a = std::cos(angle) * first + std::sin(angle) * second,
                   b = -std::sin(angle) * first + std::cos(angle) * second;
    EXPECT_NEAR(density.against(a, b, 50.0, 1.0, 0.0).log_density, reference, 0.05) << angle;
  }
  EXPECT_LT(density.against(second).log_density, reference - 100.0);
}

TEST(ShapeDensity, SlopeAgreesWithDifferences) {
  MatrixXd sigma = isotropic(4, 0.05);
  sigma(0, 1) = sigma(1, 0) = 0.001;
  const ShapeDensity density(vector({0.4, 1.0, -0.3, 0.7}), sigma);
  const VectorXd computed = vector({0.5, 1.1, -0.2, 0.6});
  const VectorXd slope = density.slope(computed, 1.0, 1e-4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    VectorXd up = computed, down = computed;
    up[i] += 1e-6, down[i] -= 1e-6;
    EXPECT_NEAR(slope[i],
                (density.against(up, 1.0, 1e-4).log_density -
                 density.against(down, 1.0, 1e-4).log_density) /
                    2e-6,
                1e-5 * slope.norm());
  }
  EXPECT_NEAR(slope.dot(computed), 0.0, 1e-10) << "its scale does not matter";
}

TEST(ShapeDensity, RejectsInvalidCovariances) {
  const VectorXd shape = vector({1.0, 0.5, 0.2});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ShapeDensity(vector({1.0}), isotropic(1, 0.1)), std::invalid_argument);
  EXPECT_THROW(ShapeDensity(vector({0.0, 0.0}), isotropic(2, 0.1)), std::invalid_argument);
  EXPECT_THROW(ShapeDensity(vector({1.0, nan}), isotropic(2, 0.1)), std::invalid_argument);
  EXPECT_THROW(ShapeDensity(shape, isotropic(2, 0.1)), std::invalid_argument);
  EXPECT_THROW(ShapeDensity(shape, MatrixXd::Zero(3, 3)), std::invalid_argument);
  MatrixXd indefinite = isotropic(3, 0.1);
  indefinite(0, 1) = indefinite(1, 0) = 0.02;
  EXPECT_THROW(ShapeDensity(shape, indefinite), std::invalid_argument);
  MatrixXd lopsided = isotropic(3, 0.1);
  lopsided(0, 1) = 0.002;
  EXPECT_THROW(ShapeDensity(shape, lopsided), std::invalid_argument);
}

// Mixed modes add a covariance with one rank per mode.
TEST(ShapeDensity, MixedModesAddNoiseAlongThem) {
  const VectorXd measured = vector({0.4, 1.0, -0.3, 0.7}), computed = vector({0.5, 0.9, -0.2, 0.8});
  MatrixXd others(4, 2);
  others << 1.0, 0.2, -0.4, 0.6, 0.3, -1.0, 0.8, 0.5;
  const VectorXd tau = vector({0.1, 0.03});
  const double a = computed.dot(measured) / computed.squaredNorm();
  const MatrixXd spread = others * (a * tau).asDiagonal();
  const MatrixXd sigma = 0.0009 * vector({1.0, 2.0, 0.5, 1.5}).asDiagonal().toDenseMatrix();
  const auto found =
      ShapeDensity(measured, sigma).against(computed, {.others = others, .tau = tau}, 2.0, 1e-4);
  const MatrixXd whole =
      2.0 * sigma + 1e-4 * MatrixXd::Identity(4, 4) + spread * spread.transpose();
  const auto expected = ShapeDensity(measured, whole).against(computed);
  EXPECT_NEAR(found.log_density, expected.log_density, 1e-10);
  EXPECT_NEAR(found.chi_square, expected.chi_square, 1e-9);
}

// Integral over all directions of two entries, with arc lengths r dθ at the shape's size.
TEST(ShapeDensity, TheUniformDensityIntegratesToOne) {
  double sum = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / kSteps;
    const VectorXd shape = Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const ShapeDensity density(shape, 1e-4 * MatrixXd::Identity(2, 2));
    sum += std::exp(density.log_uniform_density()) * density.values().norm() * std::numbers::pi /
           kSteps;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

}  // namespace
}  // namespace wheeltap::identification
