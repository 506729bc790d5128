// summary.json of a model-updating run.
#pragma once

#include "apps/cases/update_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/structural/updating/update_findings.hpp"

namespace wheeltap::apps {

/// Returns a summary. In addition to the common parts, the summary has "contraction" of each
/// parameter; "cannot_tell" (sentences, "entangled" pairs, "untouched" directions); "data" with
/// "modes" (frequency, residual, MAC, matching, information); "mac", "predictions",
/// "reduced_basis"; and, with repeated tests, "repeats".
[[nodiscard]] Report update_summary(const UpdateCaseFile& parsed,
                                    const identification::UpdateProblem& problem,
                                    const identification::UpdateFindings& findings,
                                    const RunInfo& info);

}  // namespace wheeltap::apps
