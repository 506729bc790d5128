#include "io/text/text_split.hpp"

#include <algorithm>

#include "io/text/text_cells.hpp"
#include "io/text/text_number.hpp"

namespace wheeltap::io {
namespace {

std::string_view without_sign(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  return text;
}

/// "20210301100000": true if the digits are more likely a date than a number.
bool is_long_stamp(std::string_view cell) {
  const std::size_t digits = std::min(cell.find_first_not_of("0123456789"), cell.size());
  return (digits == 14 || digits == 17) && (cell[0] == '1' || cell[0] == '2') &&
         read_stamp(cell).stamp;
}

}  // namespace

CellKind kind_of(std::string_view cell, const Reading& reading) {
  const std::optional<TimeFormat>& format = reading.format;
  if (is_missing_value(cell)) return CellKind::number;
  if (!is_long_stamp(cell) && (parse_number(cell, reading.decimal) ||
                               parse_grouped_number(cell, reading.decimal, reading.grouped)))
    return CellKind::number;
  if (format && !format->pattern.empty())
    return read_stamp(cell, format->pattern) ? CellKind::stamp : CellKind::text;
  const StampReading stamp = read_stamp(cell, format ? format->order : DayOrder::unknown);
  return stamp.stamp || stamp.ambiguous ? CellKind::stamp : CellKind::text;
}

Split split(std::string_view line, char separator, const Reading& reading) {
  Split out{.cells = loose_cells(line, separator)};
  for (const std::string& cell : out.cells) {
    const CellKind kind = kind_of(cell, reading);
    if (kind == CellKind::text) ++out.texts;
    if (kind == CellKind::stamp) ++out.stamps;
    if (kind == CellKind::number && !is_missing_value(cell)) ++out.numbers;
  }
  while (out.trailing + 1 < out.cells.size() &&
         out.cells[out.cells.size() - 1 - out.trailing].empty())
    ++out.trailing;
  return out;
}

long explained_cells(std::span<const TextLine> lines, char separator, const Reading& reading) {
  long out = 0;
  for (const TextLine& line : lines) {
    if (line.is_comment) continue;
    const Split s = split(line.text, separator, reading);
    const auto found = static_cast<long>(s.numbers + s.stamps);
    out += s.is_row() ? 2 * found : std::max(0L, found - static_cast<long>(s.texts));
  }
  return out;
}

Commas commas_of(const std::vector<Split>& rows, std::size_t columns, std::size_t names) {
  if (columns < 2 || columns % 2 != 0 || rows.empty()) return Commas::separate;
  bool leading_zero = false;
  std::vector<bool> zero_in(columns / 2, false);
  for (const Split& row : rows) {
    if (row.cells.size() != columns) continue;
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string_view cell = row.cells[c];
      if (c % 2 == 0 && !all_digits(without_sign(cell))) return Commas::separate;
      if (c % 2 == 0 && (cell == "-0" || cell == "+0")) zero_in[c / 2] = true;
      if (c % 2 == 0) continue;
      // Check the digits after the comma without their exponent.
      const std::string_view digits = cell.substr(0, cell.find_first_of("eE"));
      if (!all_digits(digits)) return Commas::separate;
      if (digits.size() > 1 && digits.front() == '0') zero_in[c / 2] = true;
    }
  }
  leading_zero = std::ranges::all_of(zero_in, [](bool zero) { return zero; });
  if (names == columns) return Commas::separate;
  if (names * 2 == columns) return columns == 2 ? Commas::decimal : Commas::mixed;
  if (names > 0) return Commas::separate;
  if (leading_zero) return columns == 2 ? Commas::decimal : Commas::mixed;
  if (columns > 2) return Commas::separate;
  // A first column with a constant step is an index or a time, so that commas separate cells.
  if (rows.size() >= 5) {
    const auto first = [&](std::size_t row) {
      return parse_number(rows[row].cells.front()).value_or(0.0);
    };
    const double step = first(1) - first(0);
    bool counts = step != 0.0;
    for (std::size_t row = 2; row < rows.size() && counts; ++row)
      counts = first(row) - first(row - 1) == step;
    if (counts) return Commas::separate;
  }
  return Commas::unclear;
}

}  // namespace wheeltap::io
