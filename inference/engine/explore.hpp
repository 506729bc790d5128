// First stage of a run: locates the posterior of each model and estimates the model probabilities.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Explores each model of a short list separately (model_exploration.hpp). If models have sets of
/// components, parallel tempering from the prior first explores all models together. A long record
/// is explored with a growing number of samples (starting_points.hpp). The function stores the
/// findings, a starting point for every chain, and initial proposals.
void explore(RunContext& run, RunState& state);
/// Stores the current number of likelihood evaluations as the number that the exploration needed.
void count_exploring(RunState& state);

}  // namespace wheeltap::inference
