// A run of system identification: what it takes, and what is written of it.
#pragma once

#include <memory>
#include <optional>

#include "apps/cases/sid_case.hpp"
#include "apps/run_options.hpp"
#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/run_watch.hpp"
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
/// The same with all that is to be written of it; none on ranks but the first.
[[nodiscard]] std::optional<FinishedRun> sample_sid(std::shared_ptr<const SidCaseFile> parsed,
                                                    const CommonOptions& common,
                                                    const SamplingOptions& options,
                                                    RunWatch& watch);

}  // namespace wheeltap::apps
