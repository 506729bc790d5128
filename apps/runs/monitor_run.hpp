// A monitoring run from its case to the files in its folder, and its continuation.
#pragma once

#include <filesystem>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct MonitorRun {
  Report summary;
  std::size_t new_alarms = 0;  ///< alarms of the rows that this call processed: the last ones
};

struct MonitorRunOptions {
  bool charts = false;  ///< also run the comparison charts, over all rows
};

/// Learns, or continues from FOLDER/state.nc where common.resume is set and the file exists; takes
/// all rows that are new; writes summary.json, series.csv, state.nc, report.html and, with charts,
/// charts.csv as if at once. Throws Failure (65) where the case is another one than that of the
/// state, or rows that were processed have changed; io::FileError where a file cannot be read or
/// written.
[[nodiscard]] MonitorRun run_monitor(const MonitorCaseFile& parsed, const CommonOptions& common,
                                     const MonitorRunOptions& options = {});

}  // namespace wheeltap::apps
