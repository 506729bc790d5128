// Estimates of the model probabilities before sampling: from evidence, from tempering ladders, and
// from the visits of a tuning round.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Sets RunState::log_probability and `probability` from the explorations. The probability is
/// proportional to P(m) Z_m, or to the number of visits, corrected for the adapted model weights of
/// the ladders. The numbers of visits are multiplied by one factor, which is determined from the
/// models for which both estimates are accurate. With ladders, the function also estimates each
/// model's evidence by tempering.
void estimate_probabilities(const RunContext& run, RunState& state);

/// Sets the model probabilities to the prior probabilities, for a run without likelihood.
void take_prior_probabilities(const RunContext& run, RunState& state);

/// Updates the probabilities of models with enough expected or observed visits. The updated
/// probabilities follow from the visits in the last tuning round. The probabilities of the other
/// models are then scaled, so that the ratio of their sum to the sum of the updated probabilities
/// stays the same.
void learn_probabilities(RunState& state, const PilotSamples& last_round);

}  // namespace wheeltap::inference
