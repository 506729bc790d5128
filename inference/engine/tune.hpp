// Second stage of a run: adaptive sampling of the posterior with all moves. Each round ends with a
// fit of the proposal distributions to the samples of the round.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Runs three rounds of tuning, and a longer fourth round if the model indicator has few effective
/// draws. Model weights make the visits to all models about equally frequent, so that each model
/// gets enough samples. The function stores the last fitted proposal distributions (Pilot), and the
/// model weights for the sampling stage (RunState::sampling_bias).
void tune(RunContext& run, RunState& state);

/// Pools the samples of the chains and fits the proposals (RunState::pilot) to the pooled samples.
/// Round 0 follows exploration.
void fit_proposals(RunContext& run, RunState& state, int round);

}  // namespace wheeltap::inference
