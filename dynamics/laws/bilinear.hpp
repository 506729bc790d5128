#pragma once

#include <cmath>

#include "dynamics/law.hpp"

namespace wheeltap::dynamics::laws {

/// A unilateral spring, for example a crack that transmits force only if closed:
/// T = k max(0, e) for side = "opening", T = k min(0, e) for side = "closing".
struct Bilinear {
  static constexpr LawInfo kInfo{
      .name = "bilinear",
      .formula = "opening: T = kb max(0, e); closing: T = kb min(0, e)",
      .description =
          "a unilateral spring (acts for one sign of e only), e.g. a crack that "
          "transmits force only if closed",
      .notes =
          "The key `stiffness` of the link acts for both signs of e. This law adds the stiffness "
          "kb for one sign of e. A negative kb makes the link softer for this sign.",
      .coefficients = {{{.name = "stiffness",
                         .unit = "N/m",
                         .role = factor_of(1),
                         .symbol = "kb",
                         .words = "the stiffness added for one sign of e",
                         .example = 1500.0}}},
      .one_sided = true};

  template <class V>
  static V tension(const V* c, V e, V /*rate*/) {
    return c[0] * (e > 0.0 ? e : V{});
  }
  template <class V>
  static V threshold(const V* /*c*/) {
    return V{};
  }
  static Slopes slopes(const double* c, double /*e_max*/) { return {.stiffness = std::abs(c[0])}; }
};

}  // namespace wheeltap::dynamics::laws
