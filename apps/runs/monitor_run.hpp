// A monitoring run of a case: its result files, and its continuation with new rows.
#pragma once

#include <filesystem>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

struct MonitorRun {
  Report summary;
  std::size_t new_alarms = 0;  ///< number of alarms in the rows that this call processed
};

struct MonitorRunOptions {
  bool charts = false;  ///< true: also run the comparison charts over all rows
};

/// Trains the baseline, or continues from FOLDER/state.nc if common.resume is set and the file
/// exists. Processes all new rows. Writes summary.json, series.csv, state.nc, report.html and, with
/// charts, charts.csv as one transaction. Throws Failure (65) if the case differs from the case in
/// state.nc, or if processed rows have changed; io::FileError if a file cannot be read or written.
[[nodiscard]] MonitorRun run_monitor(const MonitorCaseFile& parsed, const CommonOptions& common,
                                     const MonitorRunOptions& options = {});

}  // namespace wheeltap::apps
