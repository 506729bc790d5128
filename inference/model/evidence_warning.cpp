#include "inference/model/evidence_warning.hpp"

namespace wheeltap::inference {
std::string describe(const EvidenceWarning& warning) {
  using Kind = EvidenceWarning::Kind;
  const std::string value = std::to_string(warning.value);
  switch (warning.kind) {
    case Kind::failed:
      return "failed: " + warning.error;
    case Kind::stalled:
      return "TMCMC reached only likelihood exponent " + value + " in the allowed number of stages";
    case Kind::replicates_scatter:
      return "TMCMC replicates differ by more than half a nat (" + value + "); use more samples";
    case Kind::samples_hardly_move:
      return "TMCMC samples hardly moved in one of the stages; use more samples";
    case Kind::bridge_unsettled:
      return "bridge sampling did not converge; the proposal and the posterior hardly overlap";
    case Kind::few_bridge_draws:
      return "fewer than 100 effective posterior draws in bridge sampling (" + value +
             "); make more draws";
    case Kind::chains_disagree:
      return "chains disagree (R-hat " + value +
             "): make more draws, or use a pilot run that covers every posterior mode";
    case Kind::heavy_tail:
      return "the tail of the importance weights is too heavy (Pareto shape " + value +
             " > 0.7); the proposal misses part of the posterior";
    case Kind::few_effective_draws:
      return "importance sampling has only " + value + " effective draws";
    case Kind::not_normal:
      return "the posterior near its mode is not normal; importance sampling there changes "
             "Laplace's log evidence by " +
             value;
    case Kind::no_maximum:
      return "minus the Hessian at the mode is not positive definite; Laplace's evidence does not "
             "exist";
  }
  return {};
}

}  // namespace wheeltap::inference
