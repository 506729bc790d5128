// Separation of elastic from rigid-body frequencies.
#pragma once

#include <cstddef>
#include <vector>

namespace wheeltap::identification {

/// Index of the first elastic frequency. `frequencies_hz` ascend; at most `rigid` frequencies
/// belong to rigid-body modes (fewer if supports prevent such motions).
[[nodiscard]] inline std::size_t first_elastic(const std::vector<double>& frequencies_hz,
                                               std::size_t rigid) {
  std::size_t first = 0;
  while (first < rigid && frequencies_hz[first] <= 1e-6 * frequencies_hz[rigid]) ++first;
  return first;
}

}  // namespace wheeltap::identification
