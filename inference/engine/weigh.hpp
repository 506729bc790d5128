// What the draws, the searches and the fitted mixtures say of each model: its evidence, and how its
// draws are shared among its modes.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Fills in Posterior::found, of every model that was explored: ln Z as it was found before the
/// draws, by importance sampling from the model's mixture, and by bridge sampling between that and
/// its draws. Nothing where the likelihood is switched off.
void weigh(RunContext& run, RunState& state);

}  // namespace wheeltap::inference
