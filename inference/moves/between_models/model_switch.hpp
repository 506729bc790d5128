// Jumps between listed models that share parameters by name.
#pragma once

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Proposes another model of a list, chosen uniformly. Parameters that both have keep their values,
/// those that only the new one has are drawn from their priors:
///
///   ln ratio = Σ_lost ln φ(z) - Σ_new ln φ(z')         |J| = 1.
///
/// The source's nested map with the prior for its g; good at high temperature, where the prior is
/// the right proposal, and between models that share most of their parameters.
class ModelSwitch : public Move {
 public:
  std::optional<double> propose(const State& from, const Step& step, State& to) override;
};

}  // namespace wheeltap::inference
