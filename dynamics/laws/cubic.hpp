#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Cubic spring T = k₃ e³ (Duffing). The spring hardens for k₃ > 0 and softens for k₃ < 0. For k₃ >
/// 0 and a negative linear stiffness k, the potential of the link has two wells at e = ±√(-k/k₃).
struct Cubic {
  static constexpr LawInfo kInfo{
      .name = "cubic",
      .formula = "T = k3 e^3",
      .description = "a Duffing spring: k3 > 0 hardens, k3 < 0 softens",
      .notes =
          "If k3 > 0 and the `stiffness` k of the link is negative, the potential of the link has "
          "two wells, at e = ±sqrt(-k/k3).",
      .coefficients = {{{.name = "stiffness",
                         .unit = "N/m^3",
                         .role = factor_of(3),
                         .symbol = "k3",
                         .words = "the coefficient of e^3",
                         .example = 1e7}}}};
  static constexpr int kPower = 3;

  template <class V>
  static V tension(const V* c, V e, V /*rate*/) {
    return c[0] * e * (e * e);
  }
  static Slopes slopes(const double* c, double e_max) {
    return {.stiffness = 3.0 * std::abs(c[0]) * e_max * e_max};
  }
};

}  // namespace wheeltap::dynamics::laws
