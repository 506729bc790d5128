// First stage of a run: locates the posterior of each model and estimates the model probabilities.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Explores each model of a short list separately (model_exploration.hpp), sets of components by
/// parallel tempering from the prior first, and a long record as it grows (starting_points.hpp).
/// Stores the findings, a starting point for every chain, and first proposals.
void explore(RunContext& run, RunState& state);
/// Books all likelihood calls so far under exploration.
void count_exploring(RunState& state);

}  // namespace wheeltap::inference
