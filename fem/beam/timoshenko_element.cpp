#include "fem/beam/timoshenko_element.hpp"

#include <cmath>

namespace wheeltap::fem {

namespace {

template <class Real>
Flexure<Real> flexure_of(const Beam& beam) {
  const Real young = static_cast<Real>(beam.material.young);
  const Real shear_modulus = young / (2 * (1 + static_cast<Real>(beam.material.poisson)));
  return {.length = static_cast<Real>(beam.length) / beam.elements,
          .bending_stiffness = young * beam.section.second_moment,
          .shear_stiffness = beam.section.shear_coefficient * shear_modulus * beam.section.area,
          .mass = static_cast<Real>(beam.material.density) * beam.section.area,
          .rotary = static_cast<Real>(beam.material.density) * beam.section.second_moment};
}

}  // namespace

template <class Real>
TimoshenkoElement<Real>::TimoshenkoElement(const Beam& beam)
    : TimoshenkoElement(flexure_of<Real>(beam)) {}

template <class Real>
TimoshenkoElement<Real>::TimoshenkoElement(const Flexure<Real>& flexure)
    : l_(flexure.length),
      bending_(flexure.bending_stiffness),
      phi_(12 * bending_ / (flexure.shear_stiffness * l_ * l_)),
      mass_(flexure.mass),
      rotary_(flexure.rotary) {}

template <class Real>
auto TimoshenkoElement<Real>::bending() const -> Vector {
  using std::sqrt;
  const Real root = sqrt(bending_ / l_);
  return {0, -root, 0, root};
}

template <class Real>
auto TimoshenkoElement<Real>::shear() const -> Vector {
  using std::sqrt;
  const Real root = sqrt(12 * bending_ / (l_ * l_ * l_ * (1 + phi_)));
  return {root, root * l_ / 2, -root, root * l_ / 2};
}

template <class Real>
auto TimoshenkoElement<Real>::mass() const -> Matrix {
  const Real p = phi_, p2 = phi_ * phi_, l = l_;
  const Real t = mass_ * l / (210 * (1 + p) * (1 + p));
  const Real t11 = t * (70 * p2 + 147 * p + 78);
  const Real t12 = t * (35 * p2 + 77 * p + 44) * l / 4;
  const Real t13 = t * (35 * p2 + 63 * p + 27);
  const Real t14 = -t * (35 * p2 + 63 * p + 26) * l / 4;
  const Real t22 = t * (7 * p2 + 14 * p + 8) * l * l / 4;
  const Real t24 = -t * (7 * p2 + 14 * p + 6) * l * l / 4;
  const Real r = rotary_ / (30 * l * (1 + p) * (1 + p));
  const Real r11 = 36 * r;
  const Real r12 = r * (3 - 15 * p) * l;
  const Real r22 = r * (10 * p2 + 5 * p + 4) * l * l;
  const Real r24 = r * (5 * p2 - 5 * p - 1) * l * l;
  Matrix m;
  m << t11 + r11, t12 + r12, t13 - r11, t14 + r12,   //
      t12 + r12, t22 + r22, -t14 - r12, t24 + r24,   //
      t13 - r11, -t14 - r12, t11 + r11, -t12 - r12,  //
      t14 + r12, t24 + r24, -t12 - r12, t22 + r22;
  return m;
}

template <class Real>
auto TimoshenkoElement<Real>::deflection_row(Real xi) const -> Vector {
  const Real p = phi_, x2 = xi * xi, x3 = x2 * xi, s = 1 / (1 + p);
  return {s * (2 * x3 - 3 * x2 - p * xi + 1 + p),
          s * l_ * (x3 - (2 + p / 2) * x2 + (1 + p / 2) * xi), -s * (2 * x3 - 3 * x2 - p * xi),
          s * l_ * (x3 - (1 - p / 2) * x2 - p / 2 * xi)};
}

template <class Real>
auto TimoshenkoElement<Real>::rotation_row(Real xi) const -> Vector {
  const Real p = phi_, x2 = xi * xi, s = 1 / (1 + p);
  return {s * 6 * (x2 - xi) / l_, s * (3 * x2 - (4 + p) * xi + 1 + p), -s * 6 * (x2 - xi) / l_,
          s * (3 * x2 - (2 - p) * xi)};
}

template <class Real>
auto TimoshenkoElement<Real>::slope_row(Real xi) const -> Vector {
  const Real p = phi_, x2 = xi * xi, s = 1 / (1 + p);
  const Real chord = s * (6 * x2 - 6 * xi - p) / l_;
  return {chord, s * (3 * x2 - (4 + p) * xi + 1 + p / 2), -chord,
          s * (3 * x2 - (2 - p) * xi - p / 2)};
}

template class TimoshenkoElement<double>;
template class TimoshenkoElement<long double>;
template class TimoshenkoElement<DoubleDouble>;

}  // namespace wheeltap::fem
