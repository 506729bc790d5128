// Parameters of the intact structure in a damage run: sentences, summary.json and terminal text.
#pragma once

#include "apps/report_json.hpp"
#include "apps/results/terminal.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

/// Returns sentences on parameters whose posteriors equal their priors or pile up at a bound, on
/// pairs that are not identifiable separately, and on modes with large residuals.
[[nodiscard]] std::vector<std::string> baseline_sentences(
    const identification::DamageFindings& findings);

/// Returns the object `baseline` of summary.json.
[[nodiscard]] Report baseline_report(const identification::DamageCase& damage_case,
                                     const identification::DamageFindings& findings);

void print_baseline(const Page& page, const identification::DamageFindings& findings);

}  // namespace wheeltap::apps
