// The list of force laws. A new law is one file in laws/ and one entry in `LawList`.
//
// A law T(e, ė) is a struct with
//   kInfo                             its name and coefficients,
//   tension(c, e, ė)                  the tension [N] for coefficients c[i], over any vector type
//   V, slopes(c, e_max), feasible(c)     for the choice of the step; coefficients that make no
//   sense.
// One that is a power of the extension, T = c[0] e², c[0] e³, may say so by kPower, and one that is
// a spring beyond a threshold, T_open = c[0] max(0, e - threshold), may say so by threshold(c). One
// with `kInfo.memory` has tension(c, e, ė, ζ) and memory_rate(c, e, ė, ζ) = ζ̇ for its own state.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string_view>
#include <type_traits>

#include "dynamics/law.hpp"
#include "dynamics/laws/bilinear.hpp"
#include "dynamics/laws/bouc_wen.hpp"
#include "dynamics/laws/contact.hpp"
#include "dynamics/laws/coulomb.hpp"
#include "dynamics/laws/cubic.hpp"
#include "dynamics/laws/quadratic.hpp"
#include "dynamics/laws/quadratic_damping.hpp"

namespace wheeltap::dynamics {

template <class... Laws>
struct TypeList {
  static constexpr int kSize = static_cast<int>(sizeof...(Laws));

  /// Calls visit(Law{}) for the law at `kind`; returns whether there is one.
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

using LawList = TypeList<laws::Quadratic, laws::Cubic, laws::Bilinear, laws::Contact,
                         laws::QuadraticDamping, laws::Coulomb, laws::BoucWen>;

/// Whether a law is linear on either side of a threshold, so that a chain can be solved exactly
/// between the switches.
template <class Law>
inline constexpr bool kPiecewiseLinear = Law::kInfo.one_sided&& requires(const double* c) {
  Law::threshold(c);
};

/// Whether a law is a power of the extension.
template <class Law>
inline constexpr bool kPolynomial = requires {
  Law::kPower;
};

/// The descriptions of all laws, in the order of Law::kind.
[[nodiscard]] std::span<const LawInfo> law_infos();

/// The law called `name`, its coefficients in the order of its LawInfo; missing ones at the end
/// take their default. Throws std::invalid_argument for an unknown name, too many or too few
/// coefficients.
[[nodiscard]] Law make_law(std::string_view name, std::span<const Coefficient> coefficients,
                           Side side = Side::opening);

/// The same by type: make_law<laws::Contact>({kl, gap}, Side::closing).
template <class L>
[[nodiscard]] Law make_law(std::initializer_list<Coefficient> coefficients,
                           Side side = Side::opening) {
  static_assert(LawList::index_of<L>() >= 0, "the law is not in LawList");
  return make_law(L::kInfo.name, std::span<const Coefficient>(coefficients), side);
}

}  // namespace wheeltap::dynamics
