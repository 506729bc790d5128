// Types that all force laws of a link use: coefficients, description, largest slopes.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

namespace wheeltap::dynamics {

/// A coefficient of the model: a constant, or the entry `parameter` of the parameter vector.
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

/// The sign of the extension for which a one-sided law exerts a force.
enum class Side { opening, closing };

inline constexpr int kMaxLawCoefficients = 5;

/// Role of a coefficient in its force law. The role and the amplitudes of e and ė determine the
/// order of magnitude of the coefficient.
struct LawRole {
  enum class Kind {
    other,      ///< order of magnitude unknown
    factor,     ///< factor c in a tension c e^p ė^q
    extension,  ///< the coefficient is an extension of the link
  } kind = Kind::other;
  int p = 0, q = 0;  ///< powers p and q of Kind::factor
};

constexpr LawRole factor_of(int p, int q = 0) {
  return {.kind = LawRole::Kind::factor, .p = p, .q = q};
}

/// One coefficient of a force law: its name in a case file, SI unit, role, default value, feasible
/// range, and descriptions for the documentation.
struct LawCoefficient {
  std::string_view name;
  std::string_view unit;
  LawRole role = {};
  double otherwise = std::numeric_limits<double>::quiet_NaN();  ///< default value; NaN: the
                                                                ///< coefficient is required
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool above_lower = false;      ///< true if the value `lower` is excluded (the law divides by the
                                 ///< coefficient)
  std::string_view symbol = {};  ///< symbol in the formula of the law
  std::string_view words = {};   ///< meaning of the coefficient
  double example = 1.0;          ///< example value, for a spring of 2000 N/m and displacements of
                                 ///< about a centimetre

  [[nodiscard]] constexpr bool required() const { return otherwise != otherwise; }
  /// True if the value is finite and within the bounds `lower` and `upper`.
  [[nodiscard]] constexpr bool allows(double value) const {
    return value >= lower && value <= upper && !(above_lower && value == lower) &&
           value - value == 0.0;
  }
};

/// Description of a force law. The list of coefficients has the order in which the functions of the
/// law read them.
struct LawInfo {
  std::string_view name;     ///< key of the law in a case file
  std::string_view formula;  ///< plain text; e: extension, ė: rate of extension, T > 0: tension
  std::string_view description;  ///< meaning of the law, as a phrase
  std::string_view notes = {};   ///< further advice, in whole sentences
  std::array<LawCoefficient, kMaxLawCoefficients> coefficients;
  bool one_sided = false;  ///< one-sided: T = T_open(e, ė) for side = "opening", and
                           ///< T = -T_open(-e, -ė) for "closing"
  bool memory = false;     ///< true: the law has an internal state
  bool paced = false;      ///< the law has rates that grow with |ė| (Slopes)

  [[nodiscard]] constexpr int size() const {
    int n = 0;
    while (n < kMaxLawCoefficients && !coefficients[static_cast<std::size_t>(n)].name.empty()) ++n;
    return n;
  }
};

/// Upper bounds of the slopes of a force law for |e| <= e_max, for the choice of the time step. A
/// force law with rates that grow with |ė| (LawInfo::paced) also sets the `…_per_speed` members.
struct Slopes {
  double stiffness = 0.0;  ///< |∂T/∂e| [N/m]
  double damping = 0.0;    ///< |∂T/∂ė| at ė = 0, or an upper bound of |∂T/∂ė| [N s/m]
  double damping_per_speed = 0.0;  ///< growth of |∂T/∂ė| with |ė| [N s²/m²]
  double memory_per_speed = 0.0;   ///< |∂ζ̇/∂ζ| / |ė| of the law's internal state [1/m]
};

/// A list of the types of the force laws.
template <class... Laws>
struct TypeList {
  static constexpr int kSize = static_cast<int>(sizeof...(Laws));

  /// Calls visit(Law{}) for the law with the index `kind`. Returns false if no force law has this
  /// index.
  template <class Visitor>
  [[gnu::always_inline]] static constexpr bool visit(int kind, Visitor&& visitor) {
    int i = 0;
    return ((kind == i++ && (visitor(Laws{}), true)) || ...);
  }
  template <class Law>
  static constexpr int index_of() {
    int i = 0, found = -1;
    ((std::is_same_v<Law, Laws> ? found = i++ : i++), ...);
    return found;
  }
};

/// One force law of a link. `kind` is the index in the list of laws/list.hpp; the functions of
/// laws.hpp create laws.
struct Law {
  int kind = 0;
  std::array<Coefficient, kMaxLawCoefficients> coefficients{};
  Side side = Side::opening;
};

}  // namespace wheeltap::dynamics
