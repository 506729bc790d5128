// Memory layout of a table's values on a full-factorial grid.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "emulator/design.hpp"

namespace wheeltap::emulator {

/// One factor of a table. Values are stored as runs × responses, with the last factor varying
/// fastest.
struct GridAxis {
  Scale scale;
  std::vector<double> coordinates;  ///< s(level), increasing
  std::ptrdiff_t stride;            ///< doubles from one level to the next

  /// The cell that contains s, for s within the range: 0-based index of its lower level, at most
  /// size - 2.
  [[nodiscard]] std::ptrdiff_t cell(double s) const {
    return std::upper_bound(coordinates.begin() + 1, coordinates.end() - 1, s) -
           coordinates.begin() - 1;
  }
};

/// The axes of a table. Throws std::invalid_argument for invalid factors (at least two levels
/// each), a row count that is not the product of the level counts, no responses, or values that are
/// not finite.
[[nodiscard]] std::vector<GridAxis> grid_axes(const std::vector<Factor>& factors,
                                              const RowMatrix& values);

}  // namespace wheeltap::emulator
