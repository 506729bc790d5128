#include "io/tables/columns.hpp"

#include <algorithm>
#include <charconv>

#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {}  // namespace

Column column_of_header(std::string_view header) {
  Column column{.header = std::string(header), .name = std::string(header)};
  for (const char* brackets : {"[]", "()"}) {
    const std::size_t open = header.rfind(brackets[0]);
    if (open == std::string_view::npos || header.back() != brackets[1]) continue;
    const std::string_view within = header.substr(open + 1, header.size() - open - 2);
    const bool apart = open > 0 && header[open - 1] == ' ';
    const bool index = within.find_first_not_of("0123456789,: ") == std::string_view::npos;
    if (open == 0 || (index && !apart)) continue;
    column.name = std::string(trimmed(header.substr(0, open)));
    column.unit = std::string(trimmed(within));
    break;
  }
  return column;
}

int Columns::rows() const {
  std::size_t longest = 0;
  for (const Column& column : columns) longest = std::max(longest, column.values.size());
  return static_cast<int>(longest);
}

int Columns::find(std::string_view column) const {
  for (auto field : {&Column::header, &Column::name}) {
    std::vector<int> found;
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i].*field == column) found.push_back(static_cast<int>(i));
    if (found.size() == 1) return found.front();
    if (found.size() > 1)
      throw NoSuchColumn(file, std::string(column),
                         std::to_string(found.size()) + " columns are called '" +
                             std::string(column) + "'; use the column's number");
  }
  int place = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), place);
  if (error == std::errc() && end == column.data() + column.size() && place >= 1 &&
      place <= static_cast<int>(columns.size()))
    return place - 1;
  std::string known;
  for (const Column& c : columns) known += (known.empty() ? "'" : ", '") + c.header + "'";
  throw NoSuchColumn(file, std::string(column),
                     "no column '" + std::string(column) + "'; the columns are " + known);
}

Place Columns::place(std::size_t row, int column) const {
  Place place;
  if (column >= 0) {
    place.column = column + 1;
    place.header = columns.at(static_cast<std::size_t>(column)).header;
  }
  if (first_line == 0) {
    place.sample = static_cast<std::ptrdiff_t>(row);
    return place;
  }
  const auto before = std::upper_bound(skipped.begin(), skipped.end(), static_cast<int>(row));
  place.line = first_line + static_cast<std::ptrdiff_t>(row) + (before - skipped.begin());
  return place;
}

}  // namespace wheeltap::io
