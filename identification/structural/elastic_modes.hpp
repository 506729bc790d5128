// Separation of the frequencies of elastic modes from those of rigid-body modes.
#pragma once

#include <cstddef>
#include <vector>

namespace wheeltap::identification {

/// Index of the first elastic frequency in `frequencies_hz` (ascending). At most `rigid` of the
/// frequencies belong to rigid-body modes; supports may reduce this number.
[[nodiscard]] inline std::size_t first_elastic(const std::vector<double>& frequencies_hz,
                                               std::size_t rigid) {
  std::size_t first = 0;
  while (first < rigid && frequencies_hz[first] <= 1e-6 * frequencies_hz[rigid]) ++first;
  return first;
}

}  // namespace wheeltap::identification
