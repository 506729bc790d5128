// The record that a case's truth produces.
#pragma once

#include <cstdint>

#include "identification/sid/sid_case.hpp"
#include "signals/record.hpp"

namespace wheeltap::identification {

/// Time, excitations, and responses with Gaussian noise, one column a channel, in its raw units
/// (x - offset) / scale. Throws InvalidInput where the case has no truth, an excitation is
/// impossible, or the true model's response grows without bound.
[[nodiscard]] signals::Record simulate_record(const SidCase& sid_case, std::uint64_t seed);

}  // namespace wheeltap::identification
