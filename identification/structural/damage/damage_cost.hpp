// Estimates run time and memory of a damage case before any FE solution.
#pragma once

#include "identification/structural/damage/damage_case.hpp"
#include "inference/engine/run_cost.hpp"

namespace wheeltap::identification {

/// Run time and memory of a run with FE solutions only. The function builds neither the model space
/// nor the beam's spectrum. inference::cost_of_sampling explains `most_in_memory`. Throws
/// fem::InvalidStructure; throws std::invalid_argument if states do not fit.
[[nodiscard]] inference::RunCost cost_of_damages(const DamageCase& damage_case,
                                                 const inference::Options& options,
                                                 double most_in_memory);

/// Run time and memory of FE runs on a training grid; zero for other emulators, or without an
/// emulator.
[[nodiscard]] inference::RunCost cost_of_tables(const DamageCase& damage_case);

}  // namespace wheeltap::identification
