// An emulator as the "predictor" of a damage case.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::apps {

/// Parses the emulator at `where`, which is /predictor, or the key "emulator" of an external model.
/// Throws Failure.
[[nodiscard]] identification::EmulatorSpec parse_emulator(
    const CaseFile& file, const Pointer& where, const identification::DamageCase& damage_case);

}  // namespace wheeltap::apps
