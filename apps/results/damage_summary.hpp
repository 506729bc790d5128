// summary.json of a damage run.
#pragma once

#include "apps/cases/damage_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/structural/damage/damage_findings.hpp"

namespace wheeltap::apps {

/// What the words about a damage run refer to. The arguments must outlive it.
[[nodiscard]] Context damage_context(const DamageCaseFile& damage_case,
                                     const identification::DamageFindings& findings);

/// All that a reader should keep in mind, the gravest first.
[[nodiscard]] std::vector<std::string> damage_warnings(
    const DamageCaseFile& damage_case, const identification::DamageFindings& findings);

/// The whole of summary.json.
[[nodiscard]] Report damage_summary(const DamageCaseFile& damage_case,
                                    const identification::DamageFindings& findings,
                                    const RunInfo& info);

/// {"counts": {"1": {…}}}: an emulator's errors per count and mode.
[[nodiscard]] Report emulator_report(const identification::EmulatorFinding& emulator);

}  // namespace wheeltap::apps
