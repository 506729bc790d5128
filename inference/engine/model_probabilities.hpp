// How probable each model is, as far as a run knows before its draws: from evidence, from ladders,
// and from the visits of a round of tuning.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// RunState::log_probability and `probability`, as well as the explorations know them: P(m) Z_m, or
/// the visits over what the learnt weights of the ladders made of them. The two are brought to one
/// scale by the models that both know well. Where there are ladders, models get an annealed
/// evidence from them, too.
void estimate_probabilities(const RunContext& run, RunState& state);

/// The prior's, where the likelihood is switched off.
void take_prior_probabilities(const RunContext& run, RunState& state);

/// From the last round's visits, of the models that had enough of them, or should have had; the
/// others keep their place beside those.
void learn_probabilities(RunState& state, const PilotSamples& last_round);

}  // namespace wheeltap::inference
