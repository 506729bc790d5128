// A sweep: system identifications for several values of one entry of a case.
#pragma once

#include <spdlog/logger.h>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

/// Runs the case for each value of its sweep, prints one line per value, and writes sweep.csv,
/// summary.json and report.html. During the sweep, sweep.rows stores the finished rows. With
/// `common.resume`, finished rows are not run again. An interrupted sweep writes the result files
/// with its finished rows, but does not replace files of a complete sweep. Throws Failure.
void sweep_sid(CaseFile file, const CommonOptions& common, const SamplingOptions& options,
               spdlog::logger& log);

}  // namespace wheeltap::apps
