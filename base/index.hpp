// Eigen counts with signed numbers, the containers with unsigned ones.
#pragma once

#include <concepts>
#include <cstddef>

namespace wheeltap {

/// i, which is not negative, as the containers count.
[[nodiscard]] constexpr std::size_t index(std::integral auto i) {
  return static_cast<std::size_t>(i);
}

}  // namespace wheeltap
