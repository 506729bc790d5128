#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Quintic spring T = k₅ e⁵. The spring hardens (k₅ > 0) or softens (k₅ < 0) more strongly at large
/// extensions than a cubic spring. The series integrator does not support fifth powers, so chains
/// with this law use Runge-Kutta.
struct Quintic {
  static constexpr LawInfo kInfo{
      .name = "quintic",
      .formula = "T = k5 e^5",
      .description = "a spring that hardens (k5 > 0) or softens (k5 < 0) more than a cubic spring",
      .coefficients = {{{.name = "stiffness",
                         .unit = "N/m^5",
                         .role = factor_of(5),
                         .symbol = "k5",
                         .words = "the coefficient of e^5",
                         .example = 1e11}}}};

  template <class V>
  static V tension(const V* c, V e, V /*rate*/) {
    const V square = e * e;
    return c[0] * e * (square * square);
  }
  static Slopes slopes(const double* c, double e_max) {
    const double square = e_max * e_max;
    return {.stiffness = 5.0 * std::abs(c[0]) * square * square};
  }
};

}  // namespace wheeltap::dynamics::laws
