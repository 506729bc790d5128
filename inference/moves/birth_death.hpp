// Birth of a component and the death of one.
#pragma once

#include <memory>

#include "inference/move.hpp"
#include "inference/moves/component_proposal.hpp"

namespace wheeltap::inference {

/// From k components to k + 1 or k - 1, each proposed with probability ½; where the neighbour does
/// not exist (k = 0, k_max) the chain repeats its state, so the two probabilities are equal at the
/// ends too.
///
/// Birth draws c from q(· | set) and puts it in order; death removes one of the k + 1 uniformly:
///
///   ln ratio(birth) = ln [ 1/(k+1) ] - ln q(c | set without c)         |J| = 1.
class BirthDeath : public Move {
 public:
  BirthDeath(int kind, std::unique_ptr<ComponentProposal> proposal)
      : kind_(kind), proposal_(std::move(proposal)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  [[nodiscard]] double log_birth_ratio(int k_larger, std::span<const double> component) const;

  int kind_;
  std::unique_ptr<ComponentProposal> proposal_;
};

/// One component, chosen uniformly, is taken out and put back elsewhere:
///
///   ln ratio = ln q(c | set without c) - ln q(c' | set without c).
///
/// The residual without c is read off the atlas (InformedProposal), from the state itself on the
/// way there and from the proposed state on the way back, so that each density depends on its own
/// state only.
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
