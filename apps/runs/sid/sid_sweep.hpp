// A system identification over values of one number of its case.
#pragma once

#include <spdlog/logger.h>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// Runs the case for each value of its sweep, prints one line per value, and writes sweep.csv,
/// summary.json and report.html. During the sweep, sweep.rows stores the finished rows; with
/// `common.resume` they are not run again. An interrupted sweep writes the files with its finished
/// rows, unless files of a complete sweep exist. Throws Failure.
void sweep_sid(CaseFile file, const CommonOptions& common, const SamplingOptions& options,
               spdlog::logger& log);

}  // namespace wheeltap::apps
