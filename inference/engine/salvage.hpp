// What a run that was stopped before its draws has to show.
#pragma once

#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// Of a run that was stopped with fewer than kSalvaged draws a chain: so many draws of what it had
/// found, models as probable as their evidences and ladders make them so far, parameters from their
/// populations (the normals about their modes at the least). Nothing where nothing was found.
void salvage(RunContext& run, RunState& state);

inline constexpr int kSalvaged = 100;

}  // namespace wheeltap::inference
