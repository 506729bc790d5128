// Finds the channels in the arrays of MATLAB, HDF5, NetCDF and NumPy files.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Options for reading the arrays of a file. Options that are not set are detected.
struct ArrayLayout {
  /// true: each row of a matrix is a channel, with its samples along the last dimension; false:
  /// each column is a channel, with its samples along the first. If not set, samples run along the
  /// longest dimension.
  std::optional<bool> rows_are_channels = {};

  bool operator==(const ArrayLayout&) const = default;
};

struct ArrayShape {
  std::string name = {};
  std::string unit = {};
  std::vector<std::size_t> shape = {};  ///< empty for a single number
  bool row_major = false;               ///< the last index varies fastest; otherwise the first

  [[nodiscard]] std::size_t size() const;  ///< the largest value of the type if there are more
  [[nodiscard]] std::string shape_in_words() const;  ///< "8 x 100000"
};

/// The position of a column's numbers in its array.
struct ColumnSource {
  std::size_t array = 0, first = 0, step = 1;
};

struct ChosenColumns {
  std::size_t length = 0;
  std::vector<ColumnSource> sources = {};  ///< one per column of the table
};

/// Adds the columns, without values, of all arrays that share one channel length. If there are
/// several lengths, it is the one that most of the requested columns have, else the one whose
/// arrays hold the most numbers. A vector "a" is the column "a", a matrix "X" the columns "X(:,1)",
/// "X(:,2)", … or, along its rows, "X(1,:)", …, an array of three dimensions "H(1,1,:)", …; the
/// parts "H, real" and "H, imaginary" are "H(:,1), real" and so on. Arrays of other lengths are
/// added to `table.others`, with the name that selects them in a case. Single numbers are skipped.
[[nodiscard]] ChosenColumns choose_columns(std::span<const ArrayShape> arrays,
                                           const ArrayLayout& layout, const Wanted& wanted,
                                           Columns& table);

/// Reads the values of the requested columns. `values(i)` returns those of array i; it is called
/// once for consecutive columns of the same array.
void fill_columns(const ChosenColumns& chosen, const Wanted& wanted,
                  const std::function<std::vector<double>(std::size_t array)>& values,
                  Columns& table);

}  // namespace wheeltap::io
