// States of a case: data of the healthy and the damaged structure, each with added masses, a
// temperature and known coefficients; and the unknown coefficients.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/observed_states.hpp"

namespace wheeltap::apps {

struct SimulatedModes;

/// True if the case has states: unknown coefficients ("parameters"), or "states", "masses",
/// "temperature" or "known".
[[nodiscard]] bool has_states(const CaseFile& file);

/// The case with a prior for each coefficient that its states set ("known"), so that parsers of
/// structures treat it as a parameter. Throws Failure for a name that is also in /parameters.
[[nodiscard]] CaseFile with_known(const CaseFile& file);

/// Parses the states at /data. With `damage`, it also parses the states of the healthy structure at
/// /baseline/data. `simulated` replaces the modes at /data. Throws Failure,
/// identification::InvalidInput.
[[nodiscard]] identification::ObservedStates parse_states(
    const CaseFile& file, std::shared_ptr<const identification::StructureModel> model, bool damage,
    const SimulatedModes* simulated = nullptr);

/// Parses states into a damage case, with the measurements of all states in one vector. `uniform`
/// is true if the structure has, for all parameter values, the symmetry that it has at the prior
/// medians. Throws Failure.
void take_states(const CaseFile& file, std::shared_ptr<const identification::StructureModel> model,
                 bool uniform, identification::DamageCase& out,
                 const SimulatedModes* simulated = nullptr);

}  // namespace wheeltap::apps
