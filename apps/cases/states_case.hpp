// States of a case: data of the healthy and the damaged structure. Each state may have added
// masses, a temperature and known coefficients. The unknown coefficients are common to all states.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/observed_states.hpp"

namespace wheeltap::apps {

struct SimulatedModes;

/// True if the case has "parameters", or a key in /data or /baseline/data that requires states
/// ("states", "masses", "temperature", "known" and others).
[[nodiscard]] bool has_states(const CaseFile& file);

/// Returns the case with an added prior for each coefficient whose value the states give ("known").
/// Parsers of structures then treat these coefficients as parameters. Throws Failure for a name
/// that is also in /parameters.
[[nodiscard]] CaseFile with_known(const CaseFile& file);

/// Parses the states at /data. With `damage`, the function also parses the states of the healthy
/// structure at /baseline/data. `simulated` replaces the modes at /data. Throws Failure,
/// identification::InvalidInput.
[[nodiscard]] identification::ObservedStates parse_states(
    const CaseFile& file, std::shared_ptr<const identification::StructureModel> model, bool damage,
    const SimulatedModes* simulated = nullptr);

/// Parses states into a damage case, with the measurements of all states in one vector.
/// `uniform` is true if the symmetry of the structure is the same at all parameter values.
/// Throws Failure.
void take_states(const CaseFile& file, std::shared_ptr<const identification::StructureModel> model,
                 bool uniform, identification::DamageCase& out,
                 const SimulatedModes* simulated = nullptr);

}  // namespace wheeltap::apps
