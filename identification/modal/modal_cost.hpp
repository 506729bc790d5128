// Run time and memory of a modal identification, estimated before it runs.
#pragma once

#include "inference/engine/run_cost.hpp"

namespace wheeltap::identification {

/// Cost of identifying modes from `numbers` measured numbers.
[[nodiscard]] inline inference::RunCost cost_of_modes(double numbers) {
  // Measured run times: 2 s for eight channels of 61 440 samples, 90 s for twenty channels of a
  // million samples.
  return {.bytes = 2e8 + 4.0 * 8.0 * numbers, .seconds = 1.0 + 4e-6 * numbers};
}

}  // namespace wheeltap::identification
