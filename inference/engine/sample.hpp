// Last stage of a run: draws with a fixed kernel.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Runs burn-in at the posterior, draws, and computes the evidence of each model. If the engine
/// chooses the number of draws, it doubles them until the run may stop (convergence.hpp), and adds
/// a tempering ladder if the chains disagree without one.
void sample(RunContext& run, RunState& state);

// Its rounds. A run can be interrupted after each of them and resumed.

/// Called once after tuning: initialises the draws.
void prepare_draws(RunContext& run, RunState& state);
/// Burn-in with the weights of the draws: tuning used biased model weights, which the chains must
/// forget before draws count.
void settle(RunContext& run, RunState& state);
/// Adds the chain's state to its draws, stored states and counters.
void record(const RunContext& run, const RunState& state, const Target& target, int move,
            bool accepted, ChainState& chain, Chain& out);
/// Makes `n` more draws in every chain; fewer if the run is stopped.
void draw(RunContext& run, RunState& state, int n);

}  // namespace wheeltap::inference
