#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// T = c₂ ė |ė|: drag of a fluid. Its slope grows with the speed, which no step choice knows in
/// advance; the choice disregards it.
struct QuadraticDamping {
  static constexpr LawInfo kInfo{.name = "quadratic_damping",
                                 .coefficients = {{{"damping", "N s^2/m^2"}}}};

  template <class V>
  static V tension(const V* c, V /*e*/, V rate) {
    return c[0] * rate * (rate > 0.0 ? rate : -rate);
  }
  static Slopes slopes(const double* /*c*/, double /*e_max*/) { return {}; }
  static bool feasible(const double* /*c*/) { return true; }
};

}  // namespace wheeltap::dynamics::laws
