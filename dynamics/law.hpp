// What every force law of a link has in common: its coefficients, its name, its stiffest branch.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace wheeltap::dynamics {

/// A number of the model: known, or entry `parameter` of the parameter vector given at each
/// evaluation.
struct Coefficient {
  double value = 0.0;
  int parameter = -1;  ///< index into the parameter vector, or -1 for the constant `value`

  constexpr Coefficient() = default;
  constexpr Coefficient(double constant) : value(constant) {}  // NOLINT: a number is a coefficient
  static constexpr Coefficient of_parameter(int index) {
    Coefficient c;
    c.parameter = index;
    return c;
  }

  [[nodiscard]] constexpr bool is_constant() const { return parameter < 0; }
  [[nodiscard]] constexpr double at(std::span<const double> theta) const {
    return is_constant() ? value : theta[static_cast<std::size_t>(parameter)];
  }
};

/// The sign of the extension on which a one-sided law acts.
enum class Side { opening, closing };

inline constexpr int kMaxLawCoefficients = 5;

/// How one coefficient of a law is called in a case file, its SI unit, and what it is when left
/// out.
struct LawCoefficient {
  std::string_view name;
  std::string_view unit;
  double otherwise = std::numeric_limits<double>::quiet_NaN();  ///< NaN: must be given

  [[nodiscard]] constexpr bool required() const { return otherwise != otherwise; }
};

/// A law's own description. Coefficients are listed in the order in which the law reads them.
struct LawInfo {
  std::string_view name;  ///< its key in a case file
  std::array<LawCoefficient, kMaxLawCoefficients> coefficients;
  bool one_sided =
      false;  ///< takes a side; written for opening, closing is T(e, ė) = -T_open(-e, -ė)
  bool memory = false;  ///< carries one state of its own

  [[nodiscard]] constexpr int size() const {
    int n = 0;
    while (n < kMaxLawCoefficients && !coefficients[static_cast<std::size_t>(n)].name.empty()) ++n;
    return n;
  }
};

/// The steepest slopes |∂T/∂e| [N/m] and |∂T/∂ė| [N s/m] of a law over |e| <= e_max: what the
/// choice of the time step needs.
struct Slopes {
  double stiffness = 0.0;
  double damping = 0.0;
};

/// One law on a link: `kind` indexes the list in laws.hpp, which also makes laws.
struct Law {
  int kind = 0;
  std::array<Coefficient, kMaxLawCoefficients> coefficients{};
  Side side = Side::opening;
};

}  // namespace wheeltap::dynamics
