// The second stage: at the posterior itself, with all the moves, adapting; each round ends in a fit
// of the proposals to better samples.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Three rounds, and a longer one where those gave few effective draws of the model. The models are
/// visited about equally, so that each has its share of the samples. Leaves frozen proposals and
/// the bias that the draws are made with.
void tune(RunContext& run, RunState& state);

/// Pools what the chains have met and freezes the proposals that follow from it: RunState::pilot.
/// Round 0 ends the exploring.
void fit_proposals(RunContext& run, RunState& state, int round);

}  // namespace wheeltap::inference
