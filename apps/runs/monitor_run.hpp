// A monitoring run from its case to the files in its folder, and its continuation.
#pragma once

#include <filesystem>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// Learns, or continues from FOLDER/state.nc where common.resume is set and the file exists; takes
/// all rows that are new; writes summary.json, series.csv, state.nc and report.html as if at once.
/// Returns the summary. Throws Failure (65) where the case is another one than that of the state,
/// or rows that were processed have changed; io::FileError where a file cannot be read or written.
[[nodiscard]] Report run_monitor(const MonitorCaseFile& parsed, const CommonOptions& common);

}  // namespace wheeltap::apps
