// Run time and memory of a modal identification, estimated before it runs.
#pragma once

#include "inference/engine/run_cost.hpp"

namespace wheeltap::identification {

/// Run time and memory to identify modes from a record with a total of `numbers` samples.
[[nodiscard]] inline inference::RunCost cost_of_modes(double numbers) {
  // Measured run times: 2 s for 8 channels of 61 440 samples each, 90 s for 20 channels of a
  // million samples each.
  return {.bytes = 2e8 + 4.0 * 8.0 * numbers, .seconds = 1.0 + 4e-6 * numbers};
}

}  // namespace wheeltap::identification
