// The states of a case: what was measured of the healthy structure and of the damaged one, with
// masses added, at temperatures, with coefficients that were set; and the unknown coefficients.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/observed_states.hpp"

namespace wheeltap::apps {

struct SimulatedModes;

/// Whether the data are those of states: coefficients are unknown ("parameters"), or there are
/// "states", "masses", "temperature" or "known".
[[nodiscard]] bool has_states(const CaseFile& file);

/// The case with a prior for each coefficient that its states set ("known"), which the parsers of
/// structures then take for a parameter. Throws Failure for a name that /parameters has, too.
[[nodiscard]] CaseFile with_known(const CaseFile& file);

/// The states at /data, and, where `damage` is asked about, of the healthy structure at
/// /baseline/data. `simulated`: in place of modes at /data. Throws Failure,
/// identification::InvalidInput.
[[nodiscard]] identification::ObservedStates parse_states(
    const CaseFile& file, std::shared_ptr<const identification::StructureModel> model, bool damage,
    const SimulatedModes* simulated = nullptr);

/// Reads states into a damage case: all that was measured, in a row. `uniform`: the parameters
/// leave the structure as symmetric as it is at the medians. Throws Failure.
void take_states(const CaseFile& file, std::shared_ptr<const identification::StructureModel> model,
                 bool uniform, identification::DamageCase& out,
                 const SimulatedModes* simulated = nullptr);

}  // namespace wheeltap::apps
