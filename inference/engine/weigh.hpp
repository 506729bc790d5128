// Evidence of each model, and probability mass at each of its posterior modes, from draws, mode
// searches and fitted mixtures.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Sets Posterior::found for every explored model: ln Z as estimated before the draws, ln Z by
/// importance sampling from the model's mixture, and ln Z by bridge sampling between the mixture
/// and the model's draws. Does nothing for a run without likelihood.
void weigh(RunContext& run, RunState& state);

}  // namespace wheeltap::inference
