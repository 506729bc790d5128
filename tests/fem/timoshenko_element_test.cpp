#include "fem/beam/timoshenko_element.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/eigen_solvers.hpp"
#include "beams.hpp"

namespace wheeltap::fem {
namespace {

using Element = TimoshenkoElement<double>;

/// ∫₀¹ f(ξ) dξ by four Gauss points, exact to degree 7.
template <class F>
auto integral(F f) {
  const double a = std::sqrt(3.0 / 7.0 - 2.0 / 7.0 * std::sqrt(1.2)),
               wa = (18.0 + std::sqrt(30.0)) / 72.0;
  const double b = std::sqrt(3.0 / 7.0 + 2.0 / 7.0 * std::sqrt(1.2)),
               wb = (18.0 - std::sqrt(30.0)) / 72.0;
  return Element::Matrix(wa * (f(0.5 - 0.5 * a) + f(0.5 + 0.5 * a)) +
                         wb * (f(0.5 - 0.5 * b) + f(0.5 + 0.5 * b)));
}

class TimoshenkoElements : public testing::TestWithParam<double> {
 protected:
  Beam beam_ = thick_beam("free-free", GetParam(), 3);
  Element element_{beam_};
  double l_ = element_.length();
  double bending_ = beam_.material.young * beam_.section.second_moment;
  double shear_ =
      beam_.section.shear_coefficient * beam_.material.shear_modulus() * beam_.section.area;

  /// Derivative of a row of polynomials of degree <= 3, exact by central differences with an h⁴
  /// term.
  template <class Row>
  Element::Vector slope(Row row, double xi) const {
    const double h = 0.1;
    return Element::Vector(
        (8.0 * (row(xi + h) - row(xi - h)) - (row(xi + 2 * h) - row(xi - 2 * h))) /
        (12.0 * h * l_));
  }
};

TEST_P(TimoshenkoElements, ShapeFunctionsTakeNodalValues) {
  const Element::Matrix identity = Element::Matrix::Identity();
  EXPECT_LT((element_.deflection_row(0.0) - identity.col(0)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((element_.rotation_row(0.0) - identity.col(1)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((element_.deflection_row(1.0) - identity.col(2)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((element_.rotation_row(1.0) - identity.col(3)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_P(TimoshenkoElements, ShapeFunctionsReproduceRigidMotionAndConstantCurvature) {
  for (const double xi : {0.0, 0.2, 0.5, 0.9}) {
    EXPECT_NEAR(element_.deflection_row(xi).dot(Element::Vector{1, 0, 1, 0}), 1.0, 1e-14);
    EXPECT_NEAR(element_.deflection_row(xi).dot(Element::Vector{0, 1, l_, 1}), xi * l_, 1e-14);
    EXPECT_NEAR(element_.rotation_row(xi).dot(Element::Vector{0, 1, l_, 1}), 1.0, 1e-13);
    const Element::Vector bent{0, 0, l_ * l_ / 2, l_};
    EXPECT_NEAR(element_.deflection_row(xi).dot(bent), xi * xi * l_ * l_ / 2, 1e-14);
    EXPECT_NEAR(element_.rotation_row(xi).dot(bent), xi * l_, 1e-14);
  }
}

TEST_P(TimoshenkoElements, StiffnessIsTheStrainEnergyOfTheShapeFunctions) {
  const auto deflection = [&](double xi) { return element_.deflection_row(xi); };
  const auto rotation = [&](double xi) { return element_.rotation_row(xi); };
  const Element::Matrix expected = integral([&](double xi) {
    const Element::Vector curvature = slope(rotation, xi);
    const Element::Vector strain = slope(deflection, xi) - rotation(xi);
    return Element::Matrix(
        l_ * (bending_ * curvature * curvature.transpose() + shear_ * strain * strain.transpose()));
  });
  EXPECT_LT((element_.stiffness() - expected).norm(), 1e-11 * expected.norm());
}

TEST_P(TimoshenkoElements, MassIsTheKineticEnergyOfTheShapeFunctions) {
  const double mass = beam_.material.density * beam_.section.area;
  const double rotary = beam_.material.density * beam_.section.second_moment;
  const Element::Matrix expected = integral([&](double xi) {
    const Element::Vector w = element_.deflection_row(xi), t = element_.rotation_row(xi);
    return Element::Matrix(l_ * (mass * w * w.transpose() + rotary * t * t.transpose()));
  });
  EXPECT_LT((element_.mass() - expected).norm(), 1e-13 * expected.norm());
}

TEST_P(TimoshenkoElements, StiffnessHasRankTwo) {
  const Element::Matrix k = element_.stiffness();
  EXPECT_LT((k * Element::Vector{1, 0, 1, 0}).norm(), 1e-14 * k.norm());
  EXPECT_LT((k * Element::Vector{0, 1, l_, 1}).norm(), 1e-14 * k.norm());
}

TEST_P(TimoshenkoElements, TipDeflectionIsExactForOneElement) {
  // Cantilever under a tip force: w = F l³ / (3 E I) + F l / (κ G A) for any mesh.
  const Eigen::Matrix2d k = element_.stiffness().bottomRightCorner<2, 2>();
  const double tip = k.inverse()(0, 0);
  EXPECT_NEAR(tip / (l_ * l_ * l_ / (3 * bending_) + l_ / shear_), 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Heights, TimoshenkoElements, testing::Values(0.001, 0.1, 0.5));

}  // namespace
}  // namespace wheeltap::fem
