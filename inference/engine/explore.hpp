// The first stage: where the posterior is, model by model, and how probable each model may be.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Each model of a short list by itself (model_exploration.hpp); sets of components by parallel
/// tempering first, from the prior; a long record as it grows (starting_points.hpp). Leaves what
/// was found, every chain at a start of its own, and first proposals.
void explore(RunContext& run, RunState& state);
/// What has been spent so far was spent on exploring.
void count_exploring(RunState& state);

}  // namespace wheeltap::inference
