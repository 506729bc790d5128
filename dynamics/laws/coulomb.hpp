#pragma once

#include <cmath>

#include "base/lanes.hpp"
#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Dry friction of force F >= 0 (Coulomb):
///
/// T = F sgn(ė) in slip; in stick |T| <= F, and T has the value that keeps ė = 0.
///
/// The integrators locate the times of the transitions (kernel/friction.hpp). If the creep speed v
/// is positive or unknown (a parameter), the law is regularised:
///
///   T = F tanh(ė / v).
///
/// For |ė| < v, the regularised law acts like a viscous damper F/v, so that the link creeps instead
/// of sticking. A small v requires small time steps.
struct Coulomb {
  static constexpr LawInfo kInfo{
      .name = "coulomb",
      .formula = "T = F sgn(ė) in slip, |T| <= F in stick; with a velocity v: T = F tanh(ė/v)",
      .description = "dry friction; exact if `velocity` is omitted or 0",
      .notes =
          "A number or a name in place of the object is the force F of the exact law. In "
          "stick, the tension takes the value between -F and F that keeps ė = 0. Wheeltap "
          "computes the time of each change between stick and slip. A `velocity` v regularises "
          "the law. For |ė| < v, the law is then nearly a damper F/v, so that the link creeps "
          "instead of sticking. A small v requires small time steps. Use `velocity` only to "
          "reproduce results that were computed with the regularised law.",
      .coefficients = {{{.name = "force",
                         .unit = "N",
                         .role = factor_of(0),
                         .lower = 0.0,
                         .symbol = "F",
                         .words = "the friction force during slip",
                         .example = 3.0},
                        {.name = "velocity",
                         .unit = "m/s",
                         .otherwise = 0.0,
                         .lower = 0.0,
                         .symbol = "v",
                         .words = "the velocity v of the regularised law; 0: exact law",
                         .example = 0.01}}}};
  static constexpr int kCreep = 1;

  /// The tension during slip; 0 at rest.
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
