// Conversion of Eigen's signed indices to the unsigned indices of the standard containers.
#pragma once

#include <concepts>
#include <cstddef>

namespace wheeltap {

/// Converts an index i >= 0 to an unsigned index.
[[nodiscard]] constexpr std::size_t index(std::integral auto i) {
  return static_cast<std::size_t>(i);
}

}  // namespace wheeltap
