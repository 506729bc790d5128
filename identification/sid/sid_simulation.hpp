// Simulation of a record from the true model of a case.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::identification {

/// Returns time, excitations, and responses with Gaussian noise, one column per channel, in raw
/// units (x - offset) / scale. Throws InvalidInput if the case has no true parameters, an
/// excitation is impossible, or the true model's response grows without bound.
[[nodiscard]] signals::Record simulate_record(const SidCase& sid_case, std::uint64_t seed);

}  // namespace wheeltap::identification
