#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Quadratic damping T = c₂ ė |ė|, for example fluid drag. The slope 2 |c₂ ė| grows with |ė|.
struct QuadraticDamping {
  static constexpr LawInfo kInfo{.name = "quadratic_damping",
                                 .formula = "T = c2 ė |ė|",
                                 .description = "fluid drag",
                                 .notes =
                                     "For c2 > 0, the tension opposes the relative motion. The key "
                                     "`damping` of the link adds a tension that is linear in ė.",
                                 .coefficients = {{{.name = "damping",
                                                    .unit = "N s^2/m^2",
                                                    .role = factor_of(0, 2),
                                                    .symbol = "c2",
                                                    .words = "the coefficient of ė |ė|",
                                                    .example = 60.0}}},
                                 .paced = true};

  template <class V>
  static V tension(const V* c, V /*e*/, V rate) {
    return c[0] * rate * (rate > 0.0 ? rate : -rate);
  }
  static Slopes slopes(const double* c, double /*e_max*/) {
    return {.damping_per_speed = 2.0 * std::abs(c[0])};
  }
};

}  // namespace wheeltap::dynamics::laws
