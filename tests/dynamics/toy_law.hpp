// A law that is not part of the program, written as a contributor would: this file, and two lines
// in the list (added by CMakeLists.txt).
#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// T = k e / (1 + |e|/s): a spring that softens towards the force k s.
struct Toy {
  static constexpr LawInfo kInfo{.name = "toy",
                                 .formula = "T = k e / (1 + |e|/s)",
                                 .description = "a spring that softens",
                                 .coefficients = {{{"stiffness", "N/m"},
                                                   {.name = "reach",
                                                    .unit = "m",
                                                    .otherwise = 0.5,
                                                    .lower = 0.0,
                                                    .upper = 10.0,
                                                    .above_lower = true}}}};

  template <class V>
  static V tension(const V* c, V e, V /*rate*/) {
    return c[0] * e / (1.0 + (e > 0.0 ? e : -e) / c[1]);
  }
  static Slopes slopes(const double* c, double /*e_max*/) { return {.stiffness = std::abs(c[0])}; }
};

}  // namespace wheeltap::dynamics::laws
