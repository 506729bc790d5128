// Detection of the channels in the arrays of MATLAB, HDF5, NetCDF and NumPy files.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/tables/columns.hpp"

namespace wheeltap::io {

/// Options for reading the arrays of a file. If an option is not set, the reader detects its value.
struct ArrayLayout {
  /// If true, each row of a matrix is a channel, and the samples of a channel are along the last
  /// dimension. If false, each column is a channel, and the samples of a channel are along the
  /// first dimension. If not set, the samples are along the longest dimension.
  std::optional<bool> rows_are_channels = {};

  bool operator==(const ArrayLayout&) const = default;
};

struct ArrayShape {
  std::string name = {};
  std::string unit = {};
  std::vector<std::size_t> shape = {};  ///< empty for a single number
  bool row_major = false;               ///< true: the last index varies fastest; false: the first
                                        ///< index

  [[nodiscard]] std::size_t size() const;  ///< number of elements, limited to the largest value of
                                           ///< std::size_t
  [[nodiscard]] std::string shape_in_words() const;  ///< the shape as text: "8 x 100000"
};

/// The position of a column's numbers in its array.
struct ColumnSource {
  std::size_t array = 0, first = 0, step = 1;
};

struct ChosenColumns {
  std::size_t length = 0;
  std::vector<ColumnSource> sources = {};  ///< one per column of the table
};

/// Adds the columns of all arrays with the same channel length to `table`, without values. If the
/// arrays have several channel lengths, this function selects the most frequent length of the
/// requested columns. If no columns are requested, this function groups the arrays by channel
/// length and selects the length whose arrays contain the most numbers in total. A vector "a"
/// becomes the column "a". A matrix "X" becomes the columns "X(:,1)", "X(:,2)", … or, if rows are
/// channels, "X(1,:)", …. An array of three dimensions becomes the columns "H(1,1,:)", …. The parts
/// "H, real" and "H, imaginary" of a complex array become "H(:,1), real" and so on. Arrays with
/// other channel lengths are added to `table.others`, with the names by which a case can select
/// them. Single numbers are skipped.
[[nodiscard]] ChosenColumns choose_columns(std::span<const ArrayShape> arrays,
                                           const ArrayLayout& layout, const Wanted& wanted,
                                           Columns& table);

/// Reads the values of the requested columns into `table`. `values(i)` returns the values of array
/// i. For consecutive columns of the same array, `fill_columns` calls `values` only once.
void fill_columns(const ChosenColumns& chosen, const Wanted& wanted,
                  const std::function<std::vector<double>(std::size_t array)>& values,
                  Columns& table);

}  // namespace wheeltap::io
