// Evidence of each model, and shares of its modes, from draws, searches and fitted mixtures.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Sets Posterior::found for every explored model: ln Z from before the draws, by importance
/// sampling from the model's mixture, and by bridge sampling between the mixture and the model's
/// draws. Does nothing for a run without likelihood.
void weigh(RunContext& run, RunState& state);

}  // namespace wheeltap::inference
