// Estimates run time and memory of a damage case before any FE solution.
#pragma once

#include "identification/structural/damage/damage_case.hpp"
#include "inference/engine/run_cost.hpp"

namespace wheeltap::identification {

/// Cost of a run that uses FE solutions only; emulators cost less. The function builds neither the
/// model space nor the beam's spectrum. `most_in_memory` as in inference::cost_of_sampling. Throws
/// fem::InvalidStructure; throws std::invalid_argument if states do not fit their structure.
[[nodiscard]] inference::RunCost cost_of_damages(const DamageCase& damage_case,
                                                 const inference::Options& options,
                                                 double most_in_memory);

/// Cost of the FE runs that train the emulator; empty for finished tables, or without an emulator.
[[nodiscard]] inference::RunCost cost_of_tables(const DamageCase& damage_case);

}  // namespace wheeltap::identification
