// Draws for a run that was stopped before it had any.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// For a run stopped with fewer than kSalvaged draws per chain: creates that number of draws from
/// the findings so far. Models get the probabilities estimated from evidence and ladders,
/// parameters are drawn from the populations of the exploration, or from the normal approximations
/// at the modes. Does nothing if nothing was found.
void salvage(RunContext& run, RunState& state);

inline constexpr int kSalvaged = 100;

}  // namespace wheeltap::inference
