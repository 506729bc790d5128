// Simulation of system-identification cases; `run_sid` itself stands in commands.hpp.
#pragma once

#include "apps/case_file.hpp"
#include "apps/commands.hpp"

namespace wheeltap::apps {

/// Writes the record that the case's truth produces as CSV.
void simulate_sid(const CommonOptions& common, CaseFile file);

}  // namespace wheeltap::apps
