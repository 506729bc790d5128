#pragma once

#include <cmath>

#include "base/lanes.hpp"
#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Dry friction of force F >= 0 (Coulomb):
///
///   T = F sgn(ė) while it slips,   |T| <= F, whatever holds ė = 0, while it sticks,
///
/// located event by event (kernel/friction.hpp). With a creep speed v > 0, or one that is a
/// parameter, it is regularised:
///
///   T = F tanh(ė / v).
///
/// Within |ė| < v that is a dashpot F/v, so sticking is creep, and a small v asks for small steps.
struct Coulomb {
  static constexpr LawInfo kInfo{
      .name = "coulomb",
      .formula = "T = F sgn(ė) in slip, |T| <= F in stick; with a velocity v: T = F tanh(ė/v)",
      .description = "dry friction; exact where velocity is left out or 0",
      .notes =
          "A bare number or name is the force, exactly: while ė = 0 the link holds whatever "
          "tension up "
          "to F keeps it there, and each start and stop is located. A velocity smooths the jump; "
          "within |ė| < v it is a damper F/v, so that the link creeps where it should stick, and a "
          "small v asks for small steps. Give one only to compare with work that did.",
      .coefficients = {{{.name = "force",
                         .unit = "N",
                         .role = factor_of(0),
                         .lower = 0.0,
                         .symbol = "F",
                         .words = "the force at which it slips",
                         .example = 3.0},
                        {.name = "velocity",
                         .unit = "m/s",
                         .otherwise = 0.0,
                         .lower = 0.0,
                         .symbol = "v",
                         .words = "the speed over which the jump is smoothed; 0 is exact",
                         .example = 0.01}}}};
  static constexpr int kCreep = 1;

  /// The tension in slip, 0 at rest.
  template <class V>
  static V tension(const V* c, V /*e*/, V rate) {
    const V creep = c[0] * base::lanes::tanh(rate / c[1]);
    const V slip = rate > 0.0 ? c[0] : rate < 0.0 ? -c[0] : V{};
    return c[1] > 0.0 ? creep : slip;
  }
  template <class V>
  static V friction(const V* c) {
    return c[0];
  }
  static Slopes slopes(const double* c, double /*e_max*/) {
    return {.damping = c[1] > 0.0 ? std::abs(c[0] / c[1]) : 0.0};
  }
};

}  // namespace wheeltap::dynamics::laws
