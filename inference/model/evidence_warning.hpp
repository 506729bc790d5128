// What speaks against an evidence, as its method found it. Words are made of it by who shows it.
#pragma once

#include <concepts>
#include <limits>
#include <string>
#include <type_traits>

namespace wheeltap::inference {

struct EvidenceWarning {
  enum class Kind {
    failed,               ///< no evidence: `error` says why
    stalled,              ///< TMCMC gave up on its way from the prior; `value`: its exponent
    replicates_scatter,   ///< TMCMC's, `value` nats
    samples_hardly_move,  ///< TMCMC's, in some stage
    bridge_unsettled,     ///< the proposal and the posterior hardly overlap
    few_bridge_draws,     ///< effective ones of the posterior, `value`
    chains_disagree,      ///< `value`: R-hat
    heavy_tail,           ///< of importance weights; `value`: their Pareto shape
    few_effective_draws,  ///< of importance sampling, `value`
    not_normal,           ///< about the mode; `value`: what sampling there adds to Laplace's ln Z
    no_maximum,           ///< minus the Hessian at the mode is not positive definite
  };
  Kind kind;
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string error = {};

  bool operator==(const EvidenceWarning&) const = default;
};

/// For ranks (base/parcel.hpp), both ways.
template <class Parcel, class Warning>
requires std::same_as<std::remove_const_t<Warning>, EvidenceWarning>
void carry(Parcel& parcel, Warning& warning) {
  parcel(warning.kind, warning.value, warning.error);
}

/// One short phrase, which does not name the model.
[[nodiscard]] std::string describe(const EvidenceWarning& warning);

}  // namespace wheeltap::inference
