// Functions for the force laws of laws/list.hpp: descriptions, properties and construction.
#pragma once

#include <initializer_list>
#include <span>
#include <string_view>

#include "dynamics/law.hpp"
#include "dynamics/laws/list.hpp"

namespace wheeltap::dynamics {

/// True if a force law is linear on both sides of a threshold. A chain with only such laws has an
/// exact solution between switches.
template <class Law>
inline constexpr bool kPiecewiseLinear = Law::kInfo.one_sided&& requires(const double* c) {
  Law::threshold(c);
};

/// True if the tension of a force law is a power of the extension.
template <class Law>
inline constexpr bool kPolynomial = requires {
  Law::kPower;
};

/// True if a force law is a dry friction law. A dry friction law is exact or regularised.
template <class Law>
inline constexpr bool kFriction = requires(const double* c) {
  Law::friction(c);
  Law::kCreep;
};

/// True if a force law is exact dry friction, that is if its creep speed is the constant 0.
[[nodiscard]] bool is_dry(const Law& law);
/// True if the creep speed is a parameter and has the value 0 in these coefficients, which are then
/// infeasible. The integrators do not locate the stick-slip events of regularised friction, so no
/// time step would be short enough.
[[nodiscard]] bool has_zero_creep_speed(const Law& law, const double* c);

/// True if the coefficients `c` (in SI units) are feasible for a force law. Each coefficient must
/// be finite and within its bounds. The coefficients together must satisfy the function `feasible`
/// of the force law, if the force law has this function.
template <class L>
[[nodiscard]] bool is_feasible(const double* c) {
  for (int i = 0; i < L::kInfo.size(); ++i)
    if (!L::kInfo.coefficients[static_cast<std::size_t>(i)].allows(c[i])) return false;
  if constexpr (requires { L::feasible(c); }) return L::feasible(c);
  return true;
}

/// True if the coefficients are feasible for the force law with the index `kind`.
[[nodiscard]] bool is_feasible(int kind, const double* c);

/// Returns the descriptions of all force laws, in the order of Law::kind.
[[nodiscard]] std::span<const LawInfo> law_infos();

/// Creates the force law called `name`, with coefficients in the order of its LawInfo. Missing
/// coefficients at the end get their default values. Throws std::invalid_argument for an unknown
/// name, and for too many or too few coefficients.
[[nodiscard]] Law make_law(std::string_view name, std::span<const Coefficient> coefficients,
                           Side side = Side::opening);

/// Creates a force law from its type: make_law<laws::Contact>({kl, gap}, Side::closing).
template <class L>
[[nodiscard]] Law make_law(std::initializer_list<Coefficient> coefficients,
                           Side side = Side::opening) {
  static_assert(LawList::index_of<L>() >= 0, "the law is not in LawList");
  return make_law(L::kInfo.name, std::span<const Coefficient>(coefficients), side);
}

}  // namespace wheeltap::dynamics
