#pragma once

#include <cmath>

#include "dynamics/lane_math.hpp"
#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Smooth hysteresis in the normalised Bouc-Wen form (Ismail, Ikhouane & Rodellar 2009, section 2):
///
///   T = k e_y ζ,   ζ̇ = (ė / e_y) (1 - |ζ|ⁿ (β sgn(ė ζ) + γ)),   ζ(0) = 0,
///
/// k the stiffness before yield, e_y the yield extension. |ζ| <= (β + γ)^(-1/n); the loop
/// dissipates for -β <= γ <= β.
struct BoucWen {
  static constexpr LawInfo kInfo{.name = "bouc_wen",
                                 .coefficients = {{{"stiffness", "N/m"},
                                                   {"yield", "m"},
                                                   {"exponent", "1", 1.0},
                                                   {"beta", "1", 0.5},
                                                   {"gamma", "1", 0.5}}},
                                 .memory = true};

  template <class V>
  static V tension(const V* c, V /*e*/, V /*rate*/, V zeta) {
    return c[0] * c[1] * zeta;
  }
  template <class V>
  static V memory_rate(const V* c, V /*e*/, V rate, V zeta) {
    const V direction = rate * zeta > 0.0 ? c[3] : -c[3];
    return rate / c[1] * (1.0 - lanes::power(zeta > 0.0 ? zeta : -zeta, c[2]) * (direction + c[4]));
  }
  static Slopes slopes(const double* c, double /*e_max*/) { return {.stiffness = std::abs(c[0])}; }
  static bool feasible(const double* c) { return c[1] > 0.0 && c[2] >= 1.0 && c[3] + c[4] > 0.0; }
};

}  // namespace wheeltap::dynamics::laws
