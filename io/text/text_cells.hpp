// The cells of a line of text: comments, names and units.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

/// True if a line is a comment: it begins with "#", "%", "!", "//", "$", "&", ">", "~", "@" or
/// "***", and not with a missing value ("#N/A").
[[nodiscard]] bool is_comment_line(std::string_view line);

/// Removes the mark at the beginning of a comment or a line of names: a comment mark, ";", ":",
/// "--", or an unclosed quote.
[[nodiscard]] std::string_view without_comment_mark(std::string_view line);

/// Removes the first cell and its separator from a line; blanks and quotes remain on the cell.
/// Returns true if another cell follows.
bool take_cell(std::string_view& line, char separator, std::string_view& cell);

/// The cells of a line, trimmed and without enclosing quotes.
[[nodiscard]] std::vector<std::string> loose_cells(std::string_view line, char separator);

/// The names of `columns` columns in a line with this separator. In names separated by blanks, a
/// unit in brackets belongs to the name before it. Empty if their number differs from `columns`.
[[nodiscard]] std::vector<std::string> names_in(std::string_view line, char separator,
                                                std::size_t columns);

/// Joins cells that are separated by blanks: a unit in brackets is joined to the name before it.
[[nodiscard]] std::vector<std::string> joined_names(const std::vector<std::string>& cells);

[[nodiscard]] bool all_digits(std::string_view text);

/// The number of cells that are not empty.
[[nodiscard]] std::size_t filled(const std::vector<std::string>& cells);

/// True if the cells are units or marks for "no unit", with at least one unit.
[[nodiscard]] bool is_units_line(const std::vector<std::string>& cells);

/// True if this names a column of remarks, whose cells are empty in most rows.
[[nodiscard]] bool is_remarks_name(std::string_view name);

/// True if a text is spelled like a unit: "m/s^2", "[kN]", "(-)". Used only to distinguish a line
/// of units from a line of names; signals/units.hpp interprets units.
[[nodiscard]] bool spells_unit(std::string_view text);

}  // namespace wheeltap::io
