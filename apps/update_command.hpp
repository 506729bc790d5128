// `wheeltap update`.
#pragma once

#include "apps/case_file.hpp"
#include "apps/commands.hpp"

namespace wheeltap::apps {

/// The posterior of a structure's parameters from its measured modes: writes summary.json and
/// posterior.nc into the output folder and prints what was found.
void run_update(const CommonOptions& common, const SamplingOptions& options);
/// The case with modes simulated from its truth in place of its data.
void simulate_update(const CommonOptions& common, CaseFile file);

}  // namespace wheeltap::apps
