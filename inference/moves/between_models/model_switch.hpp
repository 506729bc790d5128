// Jumps between listed models that share parameters by name.
#pragma once

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Proposes another model of a list, chosen uniformly. Shared parameters keep their values;
/// parameters that only the new model has are drawn from their priors:
///
///   ln ratio = Σ_lost ln φ(z) - Σ_new ln φ(z')         |J| = 1.
///
/// This map is Transformation::nested with the priors of the new parameters instead of N(μ, σ²).
/// The move is efficient at high temperature, where the prior is a good proposal, and between
/// models that share most parameters.
class ModelSwitch : public Move {
 public:
  std::optional<double> propose(const State& from, const Step& step, State& to) override;
};

}  // namespace wheeltap::inference
