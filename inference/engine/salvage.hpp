// Approximate draws for a run that was stopped before each chain had kSalvaged draws.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Creates kSalvaged draws per chain from the results so far, if a run was stopped with fewer
/// draws. Model probabilities are the estimates from evidence and tempering. Parameters are drawn
/// from the exploration's populations (ModelExploration), or from the normal approximations at the
/// posterior modes. The function does nothing if the exploration found nothing.
void salvage(RunContext& run, RunState& state);

inline constexpr int kSalvaged = 100;

}  // namespace wheeltap::inference
