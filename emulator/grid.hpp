// Memory layout of the values of a table on a full-factorial grid.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "emulator/design.hpp"

namespace wheeltap::emulator {

/// One factor of a table. Values are stored as runs × responses; the last factor varies fastest.
struct GridAxis {
  Scale scale;
  std::vector<double> coordinates;  ///< s(level), increasing
  std::ptrdiff_t stride;            ///< number of doubles from one level to the next

  /// Returns the cell that contains s, for s within the range. The result is the index (from 0) of
  /// the lower level of the cell; it is at most the number of levels minus 2.
  [[nodiscard]] std::ptrdiff_t cell(double s) const {
    return std::upper_bound(coordinates.begin() + 1, coordinates.end() - 1, s) -
           coordinates.begin() - 1;
  }
};

/// Returns the axes of a table. Throws std::invalid_argument for invalid factors (at least two
/// levels each), a number of rows that is not the product of the numbers of levels, zero responses,
/// or values that are not finite.
[[nodiscard]] std::vector<GridAxis> grid_axes(const std::vector<Factor>& factors,
                                              const RowMatrix& values);

}  // namespace wheeltap::emulator
