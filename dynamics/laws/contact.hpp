#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Contact with a stop at the distance g >= 0. For side = "opening", T = k max(0, e - g). For side
/// = "closing", T = k min(0, e + g), the bumper of Tiboaca 2016 (section 6.3) with the sign
/// corrected. The force is continuous at the stop.
struct Contact {
  static constexpr LawInfo kInfo{
      .name = "contact",
      .formula = "opening: T = kc max(0, e - g); closing: T = kc min(0, e + g)",
      .description = "a stop that acts after a gap g (backlash)",
      .notes =
          "A list of two contacts, one for each side, describes a gap between two stops: "
          "`[{\"stiffness\": \"kc\", \"gap\": \"g\", \"side\": \"opening\"}, "
          "{\"stiffness\": \"kc\", \"gap\": \"g\", \"side\": \"closing\"}]`. The gap is measured "
          "from e = 0, and the force is continuous. If the link never reaches the stop, the record "
          "shows only that the gap is larger than the largest extension towards the stop.",
      .coefficients = {{{.name = "stiffness",
                         .unit = "N/m",
                         .role = factor_of(1),
                         .symbol = "kc",
                         .words = "the stiffness of the stop",
                         .example = 1e4},
                        {.name = "gap",
                         .unit = "m",
                         .role = {LawRole::Kind::extension},
                         .lower = 0.0,
                         .symbol = "g",
                         .words = "the distance from e = 0 to the stop",
                         .example = 0.004}}},
      .one_sided = true};

  template <class V>
  static V tension(const V* c, V e, V /*rate*/) {
    const V penetration = e - c[1];
    return c[0] * (penetration > 0.0 ? penetration : V{});
  }
  template <class V>
  static V threshold(const V* c) {
    return c[1];
  }
  static Slopes slopes(const double* c, double /*e_max*/) { return {.stiffness = std::abs(c[0])}; }
};

}  // namespace wheeltap::dynamics::laws
