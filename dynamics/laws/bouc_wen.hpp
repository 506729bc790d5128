#pragma once

#include <algorithm>
#include <cmath>

#include "base/lanes.hpp"
#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// Smooth hysteresis in the normalised Bouc-Wen form (Ismail, Ikhouane & Rodellar 2009, section 2):
///
///   T = k e_y ζ,   ζ̇ = (ė / e_y) (1 - |ζ|ⁿ (β sgn(ė ζ) + γ)),   ζ(0) = 0,
///
/// where k is the stiffness before yield and e_y the yield extension. The internal state is bounded
/// by |ζ| <= (β + γ)^(-1/n). The hysteresis loop dissipates energy for -β <= γ <= β.
struct BoucWen {
  static constexpr LawInfo kInfo{
      .name = "bouc_wen",
      .formula = "T = kh y z, z' = (ė/y) (1 - |z|^n (beta sgn(ė z) + gamma)), z = 0 at the start",
      .description =
          "smooth hysteresis, elastic with stiffness kh before the link yields at about e = y",
      .notes =
          "The hysteretic variable z depends on the history of the motion. With beta + gamma = 1 "
          "(default), |T| approaches kh y after yielding. With beta = gamma, the link unloads with "
          "the stiffness kh, like dry friction in series with a spring. With beta > gamma, the "
          "link "
          "unloads with a higher stiffness than kh. The sum beta + gamma must be positive. The "
          "hysteresis loop dissipates energy for -beta <= gamma <= beta.",
      .coefficients = {{{.name = "stiffness",
                         .unit = "N/m",
                         .role = factor_of(1),
                         .symbol = "kh",
                         .words = "the stiffness before yielding",
                         .example = 2000.0},
                        {.name = "yield",
                         .unit = "m",
                         .role = {LawRole::Kind::extension},
                         .lower = 0.0,
                         .above_lower = true,
                         .symbol = "y",
                         .words = "the extension at which the link yields",
                         .example = 0.002},
                        {.name = "exponent",
                         .unit = "1",
                         .otherwise = 1.0,
                         .lower = 1.0,
                         .symbol = "n",
                         .words = "yielding is gradual for n = 1, and almost sudden for n = 10"},
                        {.name = "beta",
                         .unit = "1",
                         .otherwise = 0.5,
                         .symbol = "beta",
                         .words = "the coefficient of the term with sgn(ė z)"},
                        {.name = "gamma",
                         .unit = "1",
                         .otherwise = 0.5,
                         .symbol = "gamma",
                         .words = "the coefficient of the term without sgn(ė z)"}}},
      .memory = true,
      .paced = true};

  template <class V>
  static V tension(const V* c, V /*e*/, V /*rate*/, V zeta) {
    return c[0] * c[1] * zeta;
  }
  template <class V>
  static V memory_rate(const V* c, V /*e*/, V rate, V zeta) {
    const V direction = rate * zeta > 0.0 ? c[3] : -c[3];
    return rate / c[1] *
           (1.0 - base::lanes::power(zeta > 0.0 ? zeta : -zeta, c[2]) * (direction + c[4]));
  }
  /// Computes bounds of the slopes. With the largest |ζ|, z = (β + γ)^(-1/n), the bounds are
  /// |∂ζ̇/∂ζ| <= |ė|/e_y n zⁿ⁻¹ (|β| + |γ|) and, at a reversal of the motion, |dζ/de| <= (1 + (β -
  /// γ) zⁿ) / e_y. The rate of yielding is |ė|/e_y.
  static Slopes slopes(const double* c, double /*e_max*/) {
    const double sum = c[3] + c[4], turning = std::max(1.0, 2.0 * c[3] / sum);
    const double yielding =
        c[2] * std::pow(sum, (1.0 - c[2]) / c[2]) * (std::abs(c[3]) + std::abs(c[4]));
    return {.stiffness = std::abs(c[0]) * turning,
            .memory_per_speed = std::max(1.0, yielding) / c[1]};
  }
  static bool feasible(const double* c) { return c[3] + c[4] > 0.0; }
};

}  // namespace wheeltap::dynamics::laws
