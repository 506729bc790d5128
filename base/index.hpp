// Conversion between Eigen's signed indices and the containers' unsigned ones.
#pragma once

#include <concepts>
#include <cstddef>

namespace wheeltap {

/// i >= 0 as an unsigned index.
[[nodiscard]] constexpr std::size_t index(std::integral auto i) {
  return static_cast<std::size_t>(i);
}

}  // namespace wheeltap
