// Parallel tempering over all models, one ladder per chain.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

inline constexpr int kStepsAScan = 3;  ///< kernel steps at each rung before a round of swaps

/// Largest number of models for which model weights are adapted.
inline constexpr int kBalancedModels = 64;

struct TemperOptions {
  int scans = 0;          ///< largest number of scans if no option sets the warm-up
  bool balanced = false;  ///< adapt weights so that chains visit every model at every temperature
  bool fitted = false;    ///< true: use the fitted proposals, and start from the chains' states
};

/// Runs parallel tempering from the prior. With fitted proposals, prepares the temperature ladder
/// of the sampling stage. For each chain, stores the ladder, the samples of the ladder and the
/// state at β = 1.
void temper(RunContext& run, RunState& state, const TemperOptions& how);

/// Pools the samples of all chains. If the ladders of the chains differ, their rungs are matched
/// from the coldest rung on.
void pool_ladders(const RunContext& run, RunState& state);

}  // namespace wheeltap::inference
