// Parsing of a line of text into cells, and recognition of comments, names and units.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

/// True if a line is a comment: it begins with "#", "%", "!", "//", "$", "&", ">", "~", "@" or
/// "***". A line that begins with a missing value ("#N/A") is not a comment.
[[nodiscard]] bool is_comment_line(std::string_view line);

/// Removes the mark at the beginning of a comment or a line of column names: a comment mark, ";",
/// ":", "--", or an unclosed quote.
[[nodiscard]] std::string_view without_comment_mark(std::string_view line);

/// Removes the first cell and the separator after it from `line`, and stores the cell in `cell`.
/// Blanks and quotes remain in the cell. Returns true if another cell follows.
bool take_cell(std::string_view& line, char separator, std::string_view& cell);

/// Returns the cells of a line, without blanks at either end and without enclosing quotes.
[[nodiscard]] std::vector<std::string> loose_cells(std::string_view line, char separator);

/// Returns the names of the columns in a line with this separator. If blanks separate the names, a
/// unit in brackets belongs to the name before the unit. The result is empty if the number of names
/// differs from `columns`.
[[nodiscard]] std::vector<std::string> names_in(std::string_view line, char separator,
                                                std::size_t columns);

/// Joins cells of a line in which blanks separate the cells: a unit in brackets is joined to the
/// name before the unit.
[[nodiscard]] std::vector<std::string> joined_names(const std::vector<std::string>& cells);

[[nodiscard]] bool all_digits(std::string_view text);

/// Returns the number of cells that are not empty.
[[nodiscard]] std::size_t filled(const std::vector<std::string>& cells);

/// True if each cell is a unit or a mark for "no unit", and at least one cell is a unit.
[[nodiscard]] bool is_units_line(const std::vector<std::string>& cells);

/// True if `name` is a usual name of a column of remarks. The cells of such a column are empty in
/// most rows.
[[nodiscard]] bool is_remarks_name(std::string_view name);

/// True if a string is spelled like a unit: "m/s^2", "[kN]", "(-)". Use this function only to
/// distinguish a line of units from a line of names; signals/units.hpp parses units.
[[nodiscard]] bool spells_unit(std::string_view text);

}  // namespace wheeltap::io
