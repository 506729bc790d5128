// A run of system identification: what it takes, and what is written of it.
#pragma once

#include <memory>

#include "apps/cases/sid_case.hpp"
#include "apps/runs/case_run.hpp"
#include "identification/sid/findings/sid_findings.hpp"

namespace wheeltap::apps {

/// Throws Failure (65) where a record that is to be simulated, which happens while the case is
/// parsed, takes more memory than is allowed.
void require_room_for_truth(CaseFile& file, const CommonOptions& common);

/// Of a run of the case, and what its record takes.
[[nodiscard]] RunCost cost_of_sid(const SidCaseFile& parsed, const CommonOptions& common,
                                  const SamplingOptions& options);

/// A case run to its end.
struct SidOutcome {
  identification::SidRun run;
  identification::SidPredictive predictive;
  identification::SidFindings findings;
};
/// Throws Failure.
[[nodiscard]] SidOutcome identify(const SidCaseFile& parsed, const CommonOptions& common,
                                  const SamplingOptions& options, RunWatch& watch);

/// Of a case without a sweep.
[[nodiscard]] std::unique_ptr<CaseRun> make_sid_run(CaseFile file, const CommonOptions& common,
                                                    const SamplingOptions& options);

}  // namespace wheeltap::apps
