// Which channels the arrays of a file hold: of MATLAB, HDF5, NetCDF and NumPy files alike.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// How the arrays of a file are to be taken. What is not stated is detected.
struct ArrayLayout {
  /// true: every row of a matrix is a channel, along its last dimension; false: every column, along
  /// its first. Unless stated, channels run along the longest dimension.
  std::optional<bool> rows_are_channels = {};

  bool operator==(const ArrayLayout&) const = default;
};

struct ArrayShape {
  std::string name = {};
  std::string unit = {};
  std::vector<std::size_t> shape = {};  ///< empty of a single number
  bool row_major = false;               ///< the last index runs fastest; else the first

  [[nodiscard]] std::size_t size() const;            ///< the largest number where there are more
  [[nodiscard]] std::string shape_in_words() const;  ///< "8 x 100000"
};

/// Where the numbers of a column stand in its array.
struct ColumnSource {
  std::size_t array = 0, first = 0, step = 1;
};

struct ChosenColumns {
  std::size_t length = 0;
  std::vector<ColumnSource> sources = {};  ///< of each column of the table
};

/// Adds to `table` the columns, still without values, of all arrays with one length: the one that
/// most numbers have, or another, where more of the columns that are wanted are of it. A vector "a"
/// is the column "a", a matrix "X" the columns "X(:,1)", "X(:,2)", … or, along its rows, "X(1,:)",
/// …, an array of three dimensions "H(1,1,:)", …; the parts "H, real" and "H, imaginary" are
/// "H(:,1), real" and so on. Arrays of other lengths are added to `table.others`, with how a case
/// names them. Single numbers are passed over.
[[nodiscard]] ChosenColumns choose_columns(std::span<const ArrayShape> arrays,
                                           const ArrayLayout& layout, const Wanted& wanted,
                                           Columns& table);

/// Reads the values of the columns that are wanted: `values(i)` are those of array i, asked for
/// once in a row.
void fill_columns(const ChosenColumns& chosen, const Wanted& wanted,
                  const std::function<std::vector<double>(std::size_t array)>& values,
                  Columns& table);

}  // namespace wheeltap::io
