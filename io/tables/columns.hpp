// A table as measured files hold it: named columns of numbers with their units, and single numbers.
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
  std::string header = {};  ///< as in the file: "force [N]", "X1(:,2)"; "3" in a file without any
  std::string name = {};    ///< "force"
  std::string unit = {};    ///< "N", or empty
  std::vector<double> values = {};
  /// How finely the file prints a number: its most digits after the point and most significant
  /// digits. Negative for binary files.
  int decimals = -1;
  int digits = -1;
  /// What the file holds there: numbers; time stamps, whose values are seconds since the first one;
  /// or texts, which have no values.
  CellKind cells = CellKind::number;
};

/// "force [N]" and "force (N)" are the name "force" and the unit "N". A bracket that holds an index
/// belongs to the name unless a blank stands before it: "location[1]", "X1(:,2)".
[[nodiscard]] Column column_of_header(std::string_view header);

struct Columns {
  std::string file = {};
  std::vector<Column> columns = {};  ///< of equal length, but for those that were not wanted
  std::map<std::string, double> scalars = {};
  /// What else a file of arrays holds, in words: "note (text)".
  std::vector<std::string> others = {};
  int first_line = 0;                      ///< line of row 0; 0 for binary files
  std::vector<int> skipped = {};           ///< rows before which a comment stands, increasing
  std::optional<FoundLayout> layout = {};  ///< of delimited text

  [[nodiscard]] int rows() const;
  /// Index of the column with this header, or this name, or (a number) at this place from 1. Throws
  /// FileError (corrupt), naming what there is, if there is none or several.
  [[nodiscard]] int find(std::string_view column) const;
  /// Where a row stands in the file, and a column of it; for messages.
  [[nodiscard]] Place place(std::size_t row, int column = -1) const;
};

/// For other processes (base/parcel.hpp), both ways.
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

/// Which columns are to be read: called once a column with the table's headers. The others keep
/// their headers and have no values. Empty: all.
using Wanted = std::function<bool(const Columns&, std::size_t column)>;

}  // namespace wheeltap::io
