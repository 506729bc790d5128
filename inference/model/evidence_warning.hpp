// Warnings about an evidence estimate, as values without text. The caller composes the message.
#pragma once

#include <concepts>
#include <limits>
#include <string>
#include <type_traits>

namespace wheeltap::inference {

struct EvidenceWarning {
  enum class Kind {
    failed,               ///< the evidence could not be computed; `error` gives the reason
    stalled,              ///< TMCMC stopped before β = 1; `value`: the exponent β that it reached
    replicates_scatter,   ///< the TMCMC replicates differ; `value`: standard deviation of their ln
                          ///< Z [nats]
    samples_hardly_move,  ///< the Metropolis moves of TMCMC hardly change the samples in some stage
    bridge_unsettled,     ///< the proposal and the posterior hardly overlap
    few_bridge_draws,     ///< `value`: effective posterior draws in bridge sampling
    chains_disagree,      ///< the chains have an R-hat above the limit; `value`: R-hat
    heavy_tail,           ///< importance weights have a heavy tail; `value`: their Pareto shape
    few_effective_draws,  ///< `value`: effective draws of importance sampling
    /// The posterior near its mode is not normal. `value` is ln Z by importance sampling at the
    /// posterior mode minus ln Z by Laplace's method.
    not_normal,
    no_maximum,  ///< minus the Hessian at the posterior mode is not positive definite
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

/// A short phrase that describes the warning, without the name of the model.
[[nodiscard]] std::string describe(const EvidenceWarning& warning);

}  // namespace wheeltap::inference
