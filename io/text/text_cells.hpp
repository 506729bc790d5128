// The cells of a line of text: comments, names and units.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

/// Whether a line is a comment: "#", "%", "!", "//", "$", "&", ">", "~", "@" or "***" before
/// anything else, unless that is a missing value ("#N/A").
[[nodiscard]] bool is_comment_line(std::string_view line);

/// A comment or line of names without its mark: those of comments, and ";", ":", "--", and quotes
/// that are not closed.
[[nodiscard]] std::string_view without_comment_mark(std::string_view line);

/// Takes the next cell off the front of a line, with the separator behind it; blanks and quotes
/// are still on it. Returns whether there is another.
bool take_cell(std::string_view& line, char separator, std::string_view& cell);

/// The cells of a line, trimmed and without quotes that enclose them.
[[nodiscard]] std::vector<std::string> loose_cells(std::string_view line, char separator);

/// Column names that stand in a line of `columns` names by this separator: of names separated by
/// blanks, a unit in brackets belongs to the name before it. Empty where there are not as many.
[[nodiscard]] std::vector<std::string> names_in(std::string_view line, char separator,
                                                std::size_t columns);

/// Of cells between blanks: a unit in brackets belongs to the name before it.
[[nodiscard]] std::vector<std::string> joined_names(const std::vector<std::string>& cells);

[[nodiscard]] bool all_digits(std::string_view text);

/// How many cells are not empty.
[[nodiscard]] std::size_t filled(const std::vector<std::string>& cells);

/// Whether cells are units, or say that a column has none; one is a unit.
[[nodiscard]] bool is_units_line(const std::vector<std::string>& cells);

/// Whether this names a column of remarks, whose cells most rows leave out.
[[nodiscard]] bool is_remarks_name(std::string_view name);

/// Whether a text is how a unit is spelled: "m/s^2", "[kN]", "(-)". Of no other meaning than to
/// tell a line of units from a line of names; signals/units.hpp knows what units are.
[[nodiscard]] bool spells_unit(std::string_view text);

}  // namespace wheeltap::io
