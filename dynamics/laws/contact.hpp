#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// T = k max(0, e - g), opening: a stop at distance g >= 0. Closing: k min(0, e + g), the bumper of
/// Tiboaca 2016 (section 6.3), its sign mended. The force is continuous at the stop.
struct Contact {
  static constexpr LawInfo kInfo{
      .name = "contact",
      .formula = "opening: T = k max(0, e - g); closing: T = k min(0, e + g)",
      .description = "a stop at distance g, as behind a backlash",
      .coefficients = {{{"stiffness", "N/m"}, {.name = "gap", .unit = "m", .lower = 0.0}}},
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
