// Which of a structure's frequencies are elastic.
#pragma once

#include <cstddef>
#include <vector>

namespace wheeltap::identification {

/// The first elastic one of ascending frequencies, of which at most `rigid` are of rigid-body
/// motions: supports hold such motions, so there may be fewer than without them.
[[nodiscard]] inline std::size_t first_elastic(const std::vector<double>& frequencies_hz,
                                               std::size_t rigid) {
  std::size_t first = 0;
  while (first < rigid && frequencies_hz[first] <= 1e-6 * frequencies_hz[rigid]) ++first;
  return first;
}

}  // namespace wheeltap::identification
