// Last stage of a run: draws with a fixed kernel.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Runs the burn-in, draws samples, and computes the evidence of each model. If the engine
/// chooses the number of draws, it doubles this number until the run may stop (convergence.hpp). If
/// the chains disagree, the engine adds a tempering ladder.
void sample(RunContext& run, RunState& state);

// The rounds of sample(). A run can be interrupted after each round and resumed.

/// Initialises the draws; called once after tuning.
void prepare_draws(RunContext& run, RunState& state);
/// Runs a burn-in with the model weights of the draws. Tuning used other model weights, so the
/// chains must first converge to the new stationary distribution.
void settle(RunContext& run, RunState& state);
/// Adds the current state of a chain to the chain's draws, stored states and counters.
void record(const RunContext& run, const RunState& state, const Target& target, int move,
            bool accepted, ChainState& chain, Chain& out);
/// Adds `n` draws to every chain, or fewer if the run is stopped.
void draw(RunContext& run, RunState& state, int n);

}  // namespace wheeltap::inference
