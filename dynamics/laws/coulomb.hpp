#pragma once

#include <cmath>

#include "base/lanes.hpp"
#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// T = F tanh(ė / v): dry friction of force F, regularised over the creep speed v (1 mm/s unless
/// given). Within |ė| < v it is a dashpot F/v, so sticking is creep, and a small v asks for small
/// steps.
struct Coulomb {
  static constexpr LawInfo kInfo{.name = "coulomb",
                                 .coefficients = {{{"force", "N"},
                                                   {.name = "velocity",
                                                    .unit = "m/s",
                                                    .otherwise = 1e-3,
                                                    .lower = 0.0,
                                                    .above_lower = true}}}};

  template <class V>
  static V tension(const V* c, V /*e*/, V rate) {
    return c[0] * base::lanes::tanh(rate / c[1]);
  }
  static Slopes slopes(const double* c, double /*e_max*/) {
    return {.damping = std::abs(c[0] / c[1])};
  }
};

}  // namespace wheeltap::dynamics::laws
