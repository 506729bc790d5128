// System identification and simulation of its cases; `run_sid` itself stands in commands.hpp.
#pragma once

#include <spdlog/logger.h>

#include "apps/checkpoint_file.hpp"
#include "apps/commands.hpp"
#include "apps/sid_case.hpp"
#include "identification/sid_findings.hpp"

namespace wheeltap::apps {

/// Writes the record that the case's truth produces as CSV.
void simulate_sid(const CommonOptions& common, CaseFile file);

/// A case run to its end.
struct SidOutcome {
  identification::SidRun run;
  identification::SidPredictive predictive;
  identification::SidFindings findings;
};
/// Throws Failure.
[[nodiscard]] SidOutcome identify(const SidCaseFile& parsed, const CommonOptions& common,
                                  const SamplingOptions& options, CheckpointFile& checkpoint,
                                  spdlog::logger& log);

}  // namespace wheeltap::apps
