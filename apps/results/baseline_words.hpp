// The intact structure's parameters beside its damage: in words, as a report, on the terminal.
#pragma once

#include "apps/report_json.hpp"
#include "apps/results/terminal.hpp"
#include "identification/structural/damage/damage_findings.hpp"

namespace wheeltap::apps {

/// What the data leave at its prior, what leans on a bound, what cannot be told apart, and which
/// modes of which states are off.
[[nodiscard]] std::vector<std::string> baseline_sentences(
    const identification::DamageFindings& findings);

/// `baseline` of a summary.
[[nodiscard]] Report baseline_report(const identification::DamageCase& damage_case,
                                     const identification::DamageFindings& findings);

void print_baseline(const Page& page, const identification::DamageFindings& findings);

}  // namespace wheeltap::apps
