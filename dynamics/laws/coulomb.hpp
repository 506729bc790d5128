#pragma once

#include <cmath>

#include "dynamics/lane_math.hpp"
#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// T = F tanh(ė / v): dry friction of force F, regularised over the creep speed v (1 mm/s unless
/// given). Within |ė| < v it is a dashpot F/v, so sticking is creep, and a small v asks for small
/// steps.
struct Coulomb {
  static constexpr LawInfo kInfo{.name = "coulomb",
                                 .coefficients = {{{"force", "N"}, {"velocity", "m/s", 1e-3}}}};

  template <class V>
  static V tension(const V* c, V /*e*/, V rate) {
    return c[0] * lanes::tanh(rate / c[1]);
  }
  static Slopes slopes(const double* c, double /*e_max*/) {
    return {.damping = std::abs(c[0] / c[1])};
  }
  static bool feasible(const double* c) { return c[1] > 0.0; }
};

}  // namespace wheeltap::dynamics::laws
