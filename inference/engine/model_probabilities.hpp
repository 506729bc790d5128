// Estimates of the model probabilities before the draws: from evidence, from tempering ladders, and
// from the visits of a tuning round.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Sets RunState::log_probability and `probability` from the explorations: P(m) Z_m, or the visits
/// corrected for the learned weights of the ladders. The two estimates are scaled to agree for
/// models for which both are accurate. With ladders, it also estimates each model's evidence by
/// tempering.
void estimate_probabilities(const RunContext& run, RunState& state);

/// Sets the prior model probabilities, for a run without likelihood.
void take_prior_probabilities(const RunContext& run, RunState& state);

/// Updates the probabilities of models with enough expected or observed visits from the visits of
/// the last round. The probabilities of other models keep their ratios to these.
void learn_probabilities(RunState& state, const PilotSamples& last_round);

}  // namespace wheeltap::inference
