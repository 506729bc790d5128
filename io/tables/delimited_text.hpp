// Tables as text with one row per line. Wheeltap reads all delimited text by the following grammar.
//
//   file   = [byte order mark] line…              lines end with LF, CR LF or CR
//   line   = blanks | mark anything | row         a blank line, a comment, or a row of the table
//   mark   = "#" | "%" | "!" | "//" | "$" | "&" | ">" | "~" | "@" | "***"
//   row    = cell (separator cell)… [separator]
//   cell   = blanks text blanks | blanks '"' text with "" for " '"' blanks
//   number = [+|-] digits [. digits] [e [+|-] digits] | nan | inf, with thousands separators or
//            without; an empty cell is NaN, as are NA, NULL, "-", "overload" and similar words
//   stamp  = a date or a time of day (io/text/time_stamp.hpp)
//
// A cell that is not valid UTF-8 is read as Latin-1; UTF-16 is converted.
//
// If the caller does not set an option, its value is detected (io/text/text_layout.hpp):
//
//   - the separator (comma, semicolon, tab, bar, or any run of blanks) and the decimal mark (point
//     or comma): the pair for which most cells are numbers
//   - the first row: from this row on, all lines hold numbers and stamps in the same columns
//   - the line of names above the first row, a line of units below the names, and the number of
//     other lines above the first row
//   - remarks after the rows, whose lines begin with neither a number nor a stamp; remarks are
//     ignored
//
// A first line "sep=;" states the separator. The header "force [N]" contains the name force and the
// unit N (see io/tables/columns.hpp). The caller checks the content of cells and decides whether
// rows may have fewer cells than the header.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/tables/columns.hpp"
#include "io/text/text_layout.hpp"
#include "io/text/text_number.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::io {

enum class FirstRow {
  detected,
  header  ///< the first line that is not a comment holds the names
};

/// The lines of a delimited text. A line is split into cells when a caller needs its cells.
class DelimitedText {
 public:
  /// Detects the layout of the text. Throws FileError (corrupt) for an invalid text (a NUL byte, a
  /// header with an unclosed quote). Also throws FileError (corrupt) for an ambiguous layout; the
  /// message names the option that resolves the ambiguity. Messages use `name` for the file.
  DelimitedText(std::string bytes, std::filesystem::path name,
                FirstRow first_row = FirstRow::detected, TextLayout stated = {});

  /// The columns without values. If the text has no header, the names are "1", "2", …
  [[nodiscard]] const std::vector<Column>& headers() const { return headers_; }
  [[nodiscard]] int header_line() const { return header_line_; }  ///< 0 if the text has no header
  [[nodiscard]] int rows() const { return static_cast<int>(starts_.size()); }
  /// Line number of a row, from 1. For row = `rows()`, the result is the number of the line after
  /// the last row.
  [[nodiscard]] int line(int row) const;
  /// Line number of the first empty line between the header and the last row, if there is one.
  [[nodiscard]] std::optional<int> empty_line() const {
    for (const auto& [row, number] : empty_)
      if (number > header_line_ && row < rows()) return number;
    return {};
  }
  [[nodiscard]] const FoundLayout& layout() const { return layout_; }
  /// Converts a cell to a number, with the decimal mark of this text. The result is NaN for a
  /// missing value, and std::nullopt for other cells that are not numbers.
  [[nodiscard]] std::optional<double> number(std::string_view cell) const;
  /// Returns the cells of a row, without blanks at either end and without enclosing quotes. Throws
  /// FileError (corrupt) for an unclosed quote, or for text after a closing quote.
  [[nodiscard]] std::vector<std::string> cells(int row) const;

  /// Reads all rows as numbers; columns that are not requested may have any content. An empty line
  /// between rows, or a row of another length, is an error, because each row is a sample. Throws
  /// FileError (corrupt), with the line and column.
  [[nodiscard]] Columns columns(const Wanted& wanted = {}) const;

 private:
  [[nodiscard]] std::string_view line_at(std::size_t start) const;
  /// Returns a cell without blanks at either end and without enclosing quotes.
  [[nodiscard]] std::string content(std::string_view raw, const Place& place) const;
  [[nodiscard]] std::vector<std::string> split(std::string_view line, int number) const;
  [[noreturn]] void fail(Place place, const std::string& reason) const;
  void scan();
  void find_layout(FirstRow first_row);
  void take_names(const TextLine& names, const TextLine* units);
  void drop_rows(int count);
  void drop_tail();
  void refuse_wrapped_series() const;
  [[nodiscard]] std::string no_data() const;
  [[nodiscard]] DayOrder day_order(int column) const;
  [[nodiscard]] double plain_number(const std::string& text, Place place, Column& column) const;

  std::string text_;
  std::filesystem::path name_;
  TextLayout stated_;
  FoundLayout layout_;
  TableShape shape_;
  char newline_ = '\n';
  int header_line_ = 0;
  int first_line_ = 0;
  std::vector<Column> headers_;
  std::vector<std::size_t> starts_;         ///< start of each row in the text
  std::vector<int> skipped_;                ///< rows preceded by a line that is not a row
  std::vector<std::pair<int, int>> empty_;  ///< empty lines: next row and line number
  std::vector<std::pair<std::size_t, int>> comments_;  ///< comments above the rows: offset, line
};

/// Reads a delimited text as a table. Throws FileError (corrupt).
[[nodiscard]] Columns parse_delimited_text(std::string bytes, const std::filesystem::path& name,
                                           const Wanted& wanted = {},
                                           const TextLayout& stated = {});

}  // namespace wheeltap::io
