// "predictor" in a damage case, where it is an emulator.
#pragma once

#include "apps/cases/syntax/case_file.hpp"
#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::apps {

/// `where`: the predictor, or the emulator in front of one that is not ours. Throws Failure.
[[nodiscard]] identification::EmulatorSpec parse_emulator(
    const CaseFile& file, const Pointer& where, const identification::DamageCase& damage_case);

}  // namespace wheeltap::apps
