// Parallel tempering over all models, every chain on a ladder of its own.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

inline constexpr int kStepsAScan = 3;  ///< in each rung, before a round of swaps

/// Of up to so many models the weights are learnt.
inline constexpr int kBalancedModels = 64;

struct TemperOptions {
  int scans = 0;          ///< at most, where the run's warm-up is not given
  bool balanced = false;  ///< weights keep every model in sight at every temperature
  bool fitted = false;    ///< with the pilot's proposals, from where the chains are
};

/// From the prior, or, once proposals have been fitted, to set up a ladder to draw with: leaves
/// each chain's ladder, the samples that it met, and where it is at β = 1.
void temper(RunContext& run, RunState& state, const TemperOptions& how);

/// Every chain's samples together. Ladders differ between chains: rungs are paired from the cold
/// end.
void pool_ladders(const RunContext& run, RunState& state);

}  // namespace wheeltap::inference
