// Run time and memory of a damage case, estimated before anything is solved.
#pragma once

#include "identification/structural/damage/damage_case.hpp"
#include "inference/engine/run_cost.hpp"

namespace wheeltap::identification {

/// Of a run with FE solutions throughout: emulators take less. The model space and the beam's
/// spectrum are not built for that. `most_in_memory` as in inference::cost_of_sampling. Throws
/// fem::InvalidStructure or std::invalid_argument where states do not fit their structure.
[[nodiscard]] inference::RunCost cost_of_damages(const DamageCase& damage_case,
                                                 const inference::Options& options,
                                                 double most_in_memory);

/// Of the FE runs that train the emulator; none for finished tables and without an emulator.
[[nodiscard]] inference::RunCost cost_of_tables(const DamageCase& damage_case);

}  // namespace wheeltap::identification
