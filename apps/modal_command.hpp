// `wheeltap modal CASE -o DIR`: the modes of a structure from its records.
#pragma once

#include "apps/commands.hpp"

namespace wheeltap::apps {

/// Writes modes.json, summary.json and report.html into the output folder and prints the modes.
void run_modal(const CommonOptions& common);

}  // namespace wheeltap::apps
