// The last stage: draws, from a kernel that is fixed.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Lets the chains settle, draws, and weighs the models; where the number of draws is the engine's
/// to choose, twice as many again until the run may stop (convergence.hpp), and on a ladder where
/// the chains do not agree without one.
void sample(RunContext& run, RunState& state);

// Its rounds, each of which a run can be left after and taken up again:

/// Once, after tuning: nothing has been drawn.
void prepare_draws(RunContext& run, RunState& state);
/// Iterations at the posterior itself: the chains come from a distribution over models that was
/// biased while tuning, and must forget it before they count.
void settle(RunContext& run, RunState& state);
/// Adds where a chain is to its draws, and to what is kept and counted of them.
void record(const RunContext& run, const RunState& state, const Target& target, int move,
            bool accepted, ChainState& chain, Chain& out);
/// Adds where a chain is to its draws, and to what is kept and counted of them.
void record(const RunContext& run, const RunState& state, const Target& target, int move,
            bool accepted, ChainState& chain, Chain& out);
/// `n` draws more by every chain; fewer where the run is stopped.
void draw(RunContext& run, RunState& state, int n);

}  // namespace wheeltap::inference
