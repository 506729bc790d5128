// Estimates of the model probabilities before sampling: from evidence, from tempering ladders, and
// from the visits of a tuning round.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Sets RunState::log_probability and `probability` from the explorations. The probability is
/// proportional to P(m) Z_m, or to the number of visits, corrected for the adapted model weights of
/// the ladders. The two estimates are scaled so that they agree for models with two accurate
/// estimates. With ladders, the function also estimates each model's evidence by tempering.
void estimate_probabilities(const RunContext& run, RunState& state);

/// Sets the model probabilities to the prior probabilities, for a run without likelihood.
void take_prior_probabilities(const RunContext& run, RunState& state);

/// From the visits in the last tuning round, updates the probabilities of models with enough
/// expected or observed visits. The ratios of the other models' probabilities to the updated
/// probabilities stay the same.
void learn_probabilities(RunState& state, const PilotSamples& last_round);

}  // namespace wheeltap::inference
