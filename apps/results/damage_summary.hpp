// summary.json of a damage run.
#pragma once

#include "apps/cases/damage_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"

namespace wheeltap::apps {

/// Returns the case and findings that sentences refer to. The arguments must outlive it.
[[nodiscard]] Context damage_context(const DamageCaseFile& damage_case,
                                     const identification::DamageFindings& findings);

/// Returns all warnings, the gravest first.
[[nodiscard]] std::vector<std::string> damage_warnings(
    const DamageCaseFile& damage_case, const identification::DamageFindings& findings);

/// Returns summary.json.
[[nodiscard]] Report damage_summary(const DamageCaseFile& damage_case,
                                    const identification::DamageFindings& findings,
                                    const RunInfo& info);

/// Returns an emulator's errors per count and mode: {"counts": {"1": {…}}}.
[[nodiscard]] Report emulator_report(const identification::EmulatorFinding& emulator);

}  // namespace wheeltap::apps
