#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Quadratic spring T = k₂ e²: the even part of the tension of an asymmetric spring. An example is
/// a spring whose potential has two wells of unequal depth.
struct Quadratic {
  static constexpr LawInfo kInfo{.name = "quadratic",
                                 .formula = "T = k2 e^2",
                                 .description = "the even part of an asymmetric spring force",
                                 .notes =
                                     "The tension has the same sign for e > 0 and e < 0. Combine "
                                     "the law with a `stiffness` or with the law `cubic`.",
                                 .coefficients = {{{.name = "stiffness",
                                                    .unit = "N/m^2",
                                                    .role = factor_of(2),
                                                    .symbol = "k2",
                                                    .words = "the coefficient of e^2",
                                                    .example = 6e4}}}};
  static constexpr int kPower = 2;

  template <class V>
  static V tension(const V* c, V e, V /*rate*/) {
    return c[0] * e * e;
  }
  static Slopes slopes(const double* c, double e_max) {
    return {.stiffness = 2.0 * std::abs(c[0]) * e_max};
  }
};

}  // namespace wheeltap::dynamics::laws
