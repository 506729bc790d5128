// A system identification over values of one number of its case.
#pragma once

#include <spdlog/logger.h>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// Runs the case once a value of its sweep, prints a line each, and writes sweep.csv, summary.json
/// and report.html. Finished rows are kept in sweep.rows until then; with `common.resume` they are
/// not run again. Interrupted, the files have the rows that are finished, where no whole sweep has
/// their names. Throws Failure.
void sweep_sid(CaseFile file, const CommonOptions& common, const SamplingOptions& options,
               spdlog::logger& log);

}  // namespace wheeltap::apps
