// A run of system identification: cost and results.
#pragma once

#include <memory>

#include "apps/cases/sid_case.hpp"
#include "apps/runs/case_run.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::apps {

/// Throws Failure (65) if a simulated record needs more memory than the limits allow. Call this
/// function before the case is parsed, because parsing creates the record.
void require_room_for_truth(CaseFile& file, const CommonOptions& common);

/// Returns the cost of a run of the case, including the record.
[[nodiscard]] RunCost cost_of_sid(const SidCaseFile& parsed, const CommonOptions& common,
                                  const SamplingOptions& options);

/// A complete run of a case.
struct SidOutcome {
  identification::SidRun run;
  identification::SidPredictive predictive;
  identification::SidFindings findings;
};
/// Runs a system identification of the case. Throws Failure.
[[nodiscard]] SidOutcome identify(const SidCaseFile& parsed, const CommonOptions& common,
                                  const SamplingOptions& options, RunWatch& watch);

/// Creates the run of a case without a sweep.
[[nodiscard]] std::unique_ptr<CaseRun> make_sid_run(CaseFile file, const CommonOptions& common,
                                                    const SamplingOptions& options);

}  // namespace wheeltap::apps
