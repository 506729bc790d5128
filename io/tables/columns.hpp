// Tables of measured files: named columns of numbers with units, and single numbers.
#pragma once

#include <concepts>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/file_error.hpp"
#include "io/text/text_layout.hpp"

namespace wheeltap::io {

struct Column {
  std::string header = {};  ///< header in the file: "force [N]", "X1(:,2)"; "3" in a file without
                            ///< names
  std::string name = {};    ///< name: "force"
  std::string unit = {};    ///< unit: "N"; may be empty
  std::vector<double> values = {};
  /// The printed precision of the column: the largest number of digits after the decimal point, and
  /// the largest number of significant digits. Both numbers are negative for binary files.
  int decimals = -1;
  int digits = -1;
  /// The content of the column: numbers; time stamps, with values in seconds since the first time
  /// stamp; or strings, without values.
  CellKind cells = CellKind::number;
};

/// Splits "force [N]" or "force (N)" into the name "force" and the unit "N". A bracket with an
/// index belongs to the name unless a blank precedes it: "location[1]", "X1(:,2)".
[[nodiscard]] Column column_of_header(std::string_view header);

struct Columns {
  std::string file = {};
  std::vector<Column> columns = {};  ///< columns of equal length; columns that were not requested
                                     ///< are empty
  std::map<std::string, double> scalars = {};
  /// For files of arrays: descriptions of content that is not a column, e.g. "note (text)".
  std::vector<std::string> others = {};
  int first_line = 0;                      ///< line of row 0; 0 for binary files
  std::vector<int> skipped = {};           ///< rows preceded by a comment, in ascending order
  std::optional<FoundLayout> layout = {};  ///< layout of a delimited text

  [[nodiscard]] int rows() const;
  /// Returns the index of the column with this header, this name, or this number (from 1). Throws
  /// FileError (corrupt), with the list of columns, if no column matches or several columns match.
  [[nodiscard]] int find(std::string_view column) const;
  /// Returns the position of a row and a column in the file, for messages.
  [[nodiscard]] Place place(std::size_t row, int column = -1) const;
};

/// Serialises a column for another process, or restores a serialised column (base/parcel.hpp).
template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Column>
void carry(Parcel& parcel, Of& column) {
  parcel(column.header, column.name, column.unit, column.values, column.decimals, column.digits);
}
template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Columns>
void carry(Parcel& parcel, Of& table) {
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, value] : table.scalars) {
    names.push_back(name);
    values.push_back(value);
  }
  parcel(table.file, table.columns, table.first_line, table.skipped, names, values, table.others);
  if constexpr (!std::is_const_v<Of>)
    for (std::size_t i = 0; i < names.size(); ++i) table.scalars[names[i]] = values[i];
}

/// A function that returns true for each column to read. The reader calls the function once per
/// column with the headers of the table. Columns that are not selected keep their headers and have
/// no values. An empty function selects all columns.
using Wanted = std::function<bool(const Columns&, std::size_t column)>;

}  // namespace wheeltap::io
