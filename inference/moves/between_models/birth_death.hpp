// Birth and death of components.
#pragma once

#include <memory>
#include <vector>

#include "inference/moves/between_models/component_proposal.hpp"
#include "inference/moves/mixture_jump.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// The move proposes k + 1 or k - 1 components for a state with k components, each with probability
/// ½. If the neighbouring model does not exist (at k = 0 or k_max), the chain repeats its state.
/// Birth and death thus have probability ½ also at k = 0 and k = k_max.
///
/// A birth draws a component c from q(· | set) and inserts it in order. A death removes component i
/// of the k + 1 components with probability p_i:
///
///   ln ratio(birth) = ln p_c(set with c) - ln q(c | set without c)         |J| = 1.
///
/// Without fitted proposals, p_i = 1/(k+1). With fitted proposals, p_i depends on the density q_k
/// that is fitted to the smaller model:
///
///   p_i = ε/(k+1) + (1 - ε) q_k(set without i) / Σ_j q_k(set without j):
///
/// A death therefore tends to remove a component whose removal leaves a probable state of the
/// smaller model.
class BirthDeath : public Move {
 public:
  BirthDeath(int kind, std::unique_ptr<ComponentProposal> proposal,
             std::shared_ptr<const PilotFit> pilot = nullptr)
      : kind_(kind), proposal_(std::move(proposal)), pilot_(std::move(pilot)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  /// The constant ε of p_i, which is large because a density fitted to few samples may be
  /// inaccurate.
  static constexpr double kDefensive = 0.4;

  /// Writes the death probabilities p_i of the larger set to probability_.
  void choose_deaths(const ModelSpace& space, int larger, const std::vector<double>& z);

  int kind_;
  std::unique_ptr<ComponentProposal> proposal_;
  std::shared_ptr<const PilotFit> pilot_;
  std::vector<double> component_, rest_, probability_;
};

/// Removes one component, chosen uniformly, and inserts a new component at another location:
///
///   ln ratio = ln q(c | set without c) - ln q(c' | set without c).
///
/// The residual of the set without c follows from the table of effects (InformedProposal). This
/// residual is computed from the current state for the forward density, and from the proposed state
/// for the reverse density. Each density therefore depends on one state only.
class Relocation : public Move {
 public:
  Relocation(int kind, std::unique_ptr<ComponentProposal> proposal)
      : kind_(kind), proposal_(std::move(proposal)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  int kind_;
  std::unique_ptr<ComponentProposal> proposal_;
};

}  // namespace wheeltap::inference
