// Warnings about an evidence estimate, as data. The caller writes the text for its reader.
#pragma once

#include <concepts>
#include <limits>
#include <string>
#include <type_traits>

namespace wheeltap::inference {

struct EvidenceWarning {
  enum class Kind {
    failed,               ///< no evidence; `error` gives the reason
    stalled,              ///< TMCMC stopped before β = 1; `value`: its exponent
    replicates_scatter,   ///< the replicates of TMCMC differ, by `value` nats
    samples_hardly_move,  ///< of TMCMC, in some stage
    bridge_unsettled,     ///< the proposal and the posterior hardly overlap
    few_bridge_draws,     ///< `value`: effective posterior draws in bridge sampling
    chains_disagree,      ///< `value`: R-hat
    heavy_tail,           ///< of importance weights; `value`: their Pareto shape
    few_effective_draws,  ///< `value`: effective draws of importance sampling
    not_normal,  ///< about the mode; `value`: ln Z by importance sampling there minus Laplace's
    no_maximum,  ///< minus the Hessian at the mode is not positive definite
  };
  Kind kind;
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string error = {};

  bool operator==(const EvidenceWarning&) const = default;
};

/// Packs and unpacks a warning for other ranks (base/parcel.hpp).
template <class Parcel, class Warning>
requires std::same_as<std::remove_const_t<Warning>, EvidenceWarning>
void carry(Parcel& parcel, Warning& warning) {
  parcel(warning.kind, warning.value, warning.error);
}

/// A short phrase without the model's name.
[[nodiscard]] std::string describe(const EvidenceWarning& warning);

}  // namespace wheeltap::inference
