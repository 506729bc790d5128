// An independent reference in 113 bits that shares only the description of the beam with the
// library.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::fem {

__extension__ typedef __float128
    Quad;  // a GCC and Clang extension; emulated in software, a hundred times slower

/// Counts eigenvalues of the damaged beam below a given one. The element's matrices are integrals
/// of its shape functions, which solve the static equations of a Timoshenko beam. Lagrange
/// multipliers enforce rigid supports. No reduction or factorisation of the library is used.
class QuadReference {
 public:
  QuadReference(const Beam& beam, const Defects& defects) : beam_(beam) {
    const Quad length = beam.length;
    l_ = length / beam.elements;
    flexural_ = Quad(beam.material.young) * beam.section.second_moment;
    shear_ = Quad(beam.section.shear_coefficient) * beam.section.area * beam.material.young /
             (2 * (1 + Quad(beam.material.poisson)));
    Element stiffness{}, mass{};
    integrate(stiffness, mass);

    for (const Support& s : beam.supports) {
      const double k = s.stiffness.value_or(INFINITY);
      if (s.deflection) hold(s.at, false, k);
      if (s.rotation) hold(s.at, true, k);
    }
    for (const SpringSupport& s : defects.supports) hold(s.location, s.rotation, s.stiffness);

    // A multiplier follows the last degree of freedom of its element.
    const std::size_t dofs = 2 * static_cast<std::size_t>(beam.nodes());
    std::vector<std::size_t> place(dofs);
    std::vector<std::size_t> multiplier(rigid_.size());
    std::size_t next = 0;
    for (std::size_t dof = 0; dof < dofs; ++dof) {
      place[dof] = next++;
      for (std::size_t r = 0; r < rigid_.size(); ++r)
        if (rigid_[r].first + 3 == dof) multiplier[r] = next++;
    }
    first_.assign(next, 0);
    for (std::size_t i = 0; i < next; ++i) first_[i] = i;
    const auto touch = [&](std::size_t i, std::size_t j) {
      first_[std::max(i, j)] = std::min(first_[std::max(i, j)], std::min(i, j));
    };
    for (std::size_t e = 0; e < static_cast<std::size_t>(beam.elements); ++e)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j <= i; ++j) touch(place[2 * e + i], place[2 * e + j]);
    for (std::size_t r = 0; r < rigid_.size(); ++r)
      for (std::size_t i = 0; i < 4; ++i) touch(multiplier[r], place[rigid_[r].first + i]);
    start_.assign(next + 1, 0);
    for (std::size_t i = 0; i < next; ++i) start_[i + 1] = start_[i] + i - first_[i] + 1;
    k_.assign(start_[next], 0);
    m_ = l_rows_ = k_;
    const auto add = [&](std::vector<Quad>& to, std::size_t i, std::size_t j, Quad value) {
      if (i < j) std::swap(i, j);
      to[start_[i] + j - first_[i]] += value;
    };
    for (std::size_t e = 0; e < static_cast<std::size_t>(beam.elements); ++e) {
      Quad left = 1;
      for (const Damage& d : defects.damages)
        if (static_cast<std::size_t>(beam.element_at(d.location)) == e)
          left *= 1 - Quad(d.reduction);
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          add(k_, place[2 * e + i], place[2 * e + j], left * stiffness[i][j]);
          add(m_, place[2 * e + i], place[2 * e + j], mass[i][j]);
        }
    }
    for (const auto& [row, k] : springs_)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j <= i; ++j)
          add(k_, place[row.first + i], place[row.first + j],
              k * row.coefficients[i] * row.coefficients[j]);
    // Multipliers in the units of the stiffness.
    for (std::size_t r = 0; r < rigid_.size(); ++r)
      for (std::size_t i = 0; i < 4; ++i)
        add(k_, multiplier[r], place[rigid_[r].first + i],
            rigid_[r].coefficients[i] * flexural_ / (l_ * l_ * l_));
  }

  /// Number of eigenvalues ω² below σ: negative pivots of [K - σ M, Rᵀ; R, 0], minus one per
  /// multiplier.
  [[nodiscard]] int count_below(Quad sigma) {
    int negative = 0;
    for (std::size_t i = 0; i < l_rows_.size(); ++i) l_rows_[i] = k_[i] - sigma * m_[i];
    for (std::size_t i = 0; i < first_.size(); ++i) {
      Quad* row = &l_rows_[start_[i]] - first_[i];
      for (std::size_t j = first_[i]; j < i; ++j) {
        const Quad* other = &l_rows_[start_[j]] - first_[j];
        for (std::size_t c = std::max(first_[i], first_[j]); c < j; ++c)
          row[j] -= row[c] * other[c];
      }
      for (std::size_t j = first_[i]; j < i; ++j) {
        const Quad scaled = row[j];
        row[j] /= l_rows_[start_[j + 1] - 1];
        row[i] -= scaled * row[j];
      }
      negative += row[i] < 0;
    }
    return negative - static_cast<int>(rigid_.size());
  }

  /// The number of rigid supports; each removes one degree of freedom.
  [[nodiscard]] int held() const { return static_cast<int>(rigid_.size()); }

  /// True if frequency `index` (from 0) lies in f (1 ± error).
  [[nodiscard]] bool holds(int index, double frequency_hz, double error) {
    const Quad omega = 2 * kPi * frequency_hz;
    const auto below = [&](Quad factor) { return count_below(omega * omega * factor * factor); };
    return below(1 - Quad(error)) <= index && below(1 + Quad(error)) > index;
  }

  /// f / (frequency `index`) - 1, by bisection to a relative 1e-3; 1 if it is not within 10 %.
  [[nodiscard]] double error(int index, double frequency_hz) {
    double bound = 1e-15;
    while (bound < 0.1 && !holds(index, frequency_hz, bound)) bound *= 1.5;
    return bound < 0.1 ? bound : 1.0;
  }

 private:
  using Element = std::array<std::array<Quad, 4>, 4>;
  struct Row {
    std::size_t first;
    std::array<Quad, 4> coefficients;
  };
  static constexpr Quad kPi = 3.14159265358979323846264338327950288419716939937511L;

  /// Cubic coefficients of w for a unit value of each nodal motion: w = Σ a_i x^i, and θ = w' + (EI
  /// / κGA) θ'' with θ'' = w''' = 6 a_3.
  [[nodiscard]] std::array<Quad, 4> cubic(std::size_t dof) const {
    const Quad c = 6 * flexural_ / shear_, l = l_;
    std::array<std::array<Quad, 5>, 4> a = {{{1, 0, 0, 0, 0},
                                             {0, 1, 0, c, 0},
                                             {1, l, l * l, l * l * l, 0},
                                             {0, 1, 2 * l, 3 * l * l + c, 0}}};
    a[dof][4] = 1;
    for (std::size_t i = 0; i < 4; ++i) {
      std::size_t pivot = i;
      for (std::size_t r = i; r < 4; ++r)
        if (size(a[r][i]) > size(a[pivot][i])) pivot = r;
      std::swap(a[i], a[pivot]);
      for (std::size_t r = 0; r < 4; ++r) {
        if (r == i) continue;
        const Quad factor = a[r][i] / a[i][i];
        for (std::size_t k = i; k < 5; ++k) a[r][k] -= factor * a[i][k];
      }
    }
    return {a[0][4] / a[0][0], a[1][4] / a[1][1], a[2][4] / a[2][2], a[3][4] / a[3][3]};
  }

  static Quad size(Quad x) { return x < 0 ? -x : x; }

  struct Shape {
    Quad w, theta, curvature, strain;
  };
  [[nodiscard]] Shape shape(const std::array<Quad, 4>& a, Quad x) const {
    const Quad slope = a[1] + x * (2 * a[2] + x * 3 * a[3]);
    const Quad theta = slope + 6 * flexural_ / shear_ * a[3];
    return {a[0] + x * (a[1] + x * (a[2] + x * a[3])), theta, 2 * a[2] + 6 * x * a[3],
            slope - theta};
  }

  void integrate(Element& stiffness, Element& mass) const {
    // Four Gauss-Legendre points, exact to degree 7; roots of 35 x⁴ - 30 x² + 3.
    const auto root = [](Quad square) {
      Quad x = std::sqrt(static_cast<double>(square));
      for (int i = 0; i < 4; ++i) x = (x + square / x) / 2;
      return x;
    };
    const Quad ra = Quad(beam_.material.density) * beam_.section.area,
               ri = Quad(beam_.material.density) * beam_.section.second_moment;
    std::array<std::array<Quad, 4>, 4> a;
    for (std::size_t dof = 0; dof < 4; ++dof) a[dof] = cubic(dof);
    const Quad inner = root(Quad(6) / 5);
    for (const Quad square : {(3 - 2 * inner) / 7, (3 + 2 * inner) / 7})
      for (const int side : {-1, 1}) {
        const Quad point = side * root(square);
        // Weights 2 / ((1 - x²) P₄'(x)²), P₄' = (35 x³ - 15 x) / 2.
        const Quad slope = (35 * point * square - 15 * point) / 2;
        const Quad weight = l_ / ((1 - square) * slope * slope), x = l_ * (1 + point) / 2;
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j) {
            const Shape p = shape(a[i], x), q = shape(a[j], x);
            stiffness[i][j] +=
                weight * (flexural_ * p.curvature * q.curvature + shear_ * p.strain * q.strain);
            mass[i][j] += weight * (ra * p.w * q.w + ri * p.theta * q.theta);
          }
      }
  }

  void hold(double at, bool rotation, double k) {
    const auto e = static_cast<std::size_t>(std::clamp(
        static_cast<int>(std::floor(static_cast<double>(at / l_))), 0, beam_.elements - 1));
    const Quad x = at - e * l_;
    Row row{.first = 2 * e, .coefficients = {}};
    for (std::size_t i = 0; i < 4; ++i) {
      const Shape s = shape(cubic(i), x);
      row.coefficients[i] = rotation ? s.theta * l_ : s.w;
    }
    if (std::isinf(k))
      rigid_.push_back(row);
    else
      springs_.emplace_back(row, rotation ? Quad(k) / (l_ * l_) : Quad(k));
  }

  Beam beam_;
  Quad l_, flexural_, shear_;
  std::vector<Row> rigid_;
  std::vector<std::pair<Row, Quad>> springs_;
  std::vector<std::size_t> first_, start_;
  std::vector<Quad> k_, m_, l_rows_;
};

}  // namespace wheeltap::fem
