#include "dynamics/laws.hpp"

#include <stdexcept>
#include <string>

namespace wheeltap::dynamics {

namespace {

template <class... Laws>
constexpr std::array<LawInfo, sizeof...(Laws)> collect(TypeList<Laws...>) {
  return {Laws::kInfo...};
}

constexpr auto kInfos = collect(LawList{});

}  // namespace

std::span<const LawInfo> law_infos() {
  return kInfos;
}

bool is_dry(const Law& law) {
  bool dry = false;
  LawList::visit(law.kind, [&]<class L>(L) {
    if constexpr (kFriction<L>) {
      const Coefficient& creep = law.coefficients[static_cast<std::size_t>(L::kCreep)];
      dry = creep.is_constant() && creep.value == 0.0;
    }
  });
  return dry;
}

bool has_zero_creep_speed(const Law& law, const double* c) {
  bool zero = false;
  LawList::visit(law.kind, [&]<class L>(L) {
    if constexpr (kFriction<L>) zero = c[L::kCreep] == 0.0;
  });
  return zero && !is_dry(law);
}

bool is_feasible(int kind, const double* c) {
  bool feasible = false;
  LawList::visit(kind, [&](auto law) { feasible = is_feasible<decltype(law)>(c); });
  return feasible;
}

Law make_law(std::string_view name, std::span<const Coefficient> coefficients, Side side) {
  for (std::size_t kind = 0; kind < kInfos.size(); ++kind) {
    const LawInfo& info = kInfos[kind];
    if (info.name != name) continue;
    const auto size = static_cast<std::size_t>(info.size());
    if (coefficients.size() > size)
      throw std::invalid_argument("law " + std::string(name) + ": " +
                                  std::to_string(coefficients.size()) +
                                  " coefficients, must be at most " + std::to_string(size));
    Law law{.kind = static_cast<int>(kind), .side = side};
    for (std::size_t i = 0; i < size; ++i) {
      if (i >= coefficients.size() && info.coefficients[i].required())
        throw std::invalid_argument("law " + std::string(name) + ": coefficient " +
                                    std::string(info.coefficients[i].name) + " must be given");
      law.coefficients[i] =
          i < coefficients.size() ? coefficients[i] : Coefficient(info.coefficients[i].otherwise);
    }
    return law;
  }
  throw std::invalid_argument("unknown force law '" + std::string(name) + "'");
}

}  // namespace wheeltap::dynamics
