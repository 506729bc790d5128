// summary.json of a damage run.
#pragma once

#include "apps/cases/damage_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

/// Returns the Context for sentences about this case and these findings. The arguments must outlive
/// the Context.
[[nodiscard]] Context damage_context(const DamageCaseFile& damage_case,
                                     const identification::DamageFindings& findings);

/// Returns all warnings of the run, the most serious first.
[[nodiscard]] std::vector<std::string> damage_warnings(
    const DamageCaseFile& damage_case, const identification::DamageFindings& findings);

/// Returns the content of summary.json.
[[nodiscard]] Report damage_summary(const DamageCaseFile& damage_case,
                                    const identification::DamageFindings& findings,
                                    const RunInfo& info);

/// Returns an emulator's errors per number of damages and mode: {"counts": {"1": {…}}}.
[[nodiscard]] Report emulator_report(const identification::EmulatorFinding& emulator);

}  // namespace wheeltap::apps
