// Tables as text with one row per line. This is the grammar of all delimited text that Wheeltap
// reads.
//
//   file   = [byte order mark] line…              lines end with LF, CR LF or CR
//   line   = blanks | mark anything | row         the first two are no rows
//   mark   = "#" | "%" | "!" | "//" | "$" | "&" | ">" | "~" | "@" | "***"
//   row    = cell (separator cell)… [separator]
//   cell   = blanks text blanks | blanks '"' text with "" for " '"' blanks
//   number = [+|-] digits [. digits] [e [+|-] digits] | nan | inf, with thousands separators or
//            without; an empty cell is NaN, and so are NA, NULL, "-", "overload" and the like
//   stamp  = a date or a time of day (io/text/time_stamp.hpp)
//
// A cell that is not valid UTF-8 is read as Latin-1; UTF-16 is converted.
//
// Options that are not set are detected (io/text/text_layout.hpp):
//
//   - the separator (comma, semicolon, tab, bar, or any run of blanks) and the decimal mark (point
//   or
//     comma): those that explain the most numbers
//   - the first row, from which all lines hold numbers and stamps in the same columns
//   - the line of names above it, a line of units below the names, and the number of other lines
//   above
//   - remarks after the rows, which begin with neither a number nor a stamp; they are ignored
//
// A first line "sep=;" states the separator. "force [N]" is the name force and the unit N (see
// io/tables/columns.hpp). The caller checks the content of cells and decides whether rows may be
// short.
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

/// The lines of a delimited text; a line is split into cells when it is needed.
class DelimitedText {
 public:
  /// Throws FileError (corrupt) for an invalid text (a NUL byte, a header with an unclosed quote)
  /// and for an ambiguous layout, with the option that resolves it. Messages use `name` for the
  /// file.
  DelimitedText(std::string bytes, std::filesystem::path name,
                FirstRow first_row = FirstRow::detected, TextLayout stated = {});

  /// One entry per column, without values. Without a header the names are "1", "2", …
  [[nodiscard]] const std::vector<Column>& headers() const { return headers_; }
  [[nodiscard]] int header_line() const { return header_line_; }  ///< 0 if there is none
  [[nodiscard]] int rows() const { return static_cast<int>(starts_.size()); }
  /// Line of a row, from 1; for `rows()`, the line after the last row.
  [[nodiscard]] int line(int row) const;
  [[nodiscard]] const FoundLayout& layout() const { return layout_; }
  /// A cell as a number, with the decimal mark of this text; NaN for a missing value.
  [[nodiscard]] std::optional<double> number(std::string_view cell) const;
  /// The cells of a row, trimmed and without their quotes. Throws FileError (corrupt) for a quote
  /// that is not closed, or text after one.
  [[nodiscard]] std::vector<std::string> cells(int row) const;

  /// All rows as numbers; columns that are not requested may have any content. An empty line
  /// between rows, or a row of another length, is an error, because each row is a sample. Throws
  /// FileError (corrupt), with the line and column.
  [[nodiscard]] Columns columns(const Wanted& wanted = {}) const;

 private:
  [[nodiscard]] std::string_view line_at(std::size_t start) const;
  /// A cell without its blanks and quotes.
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
  std::vector<std::pair<int, int>> empty_;  ///< empty lines: the next row, the line number
  std::vector<std::pair<std::size_t, int>> comments_;  ///< comments of the head: start, line
};

/// Reads a delimited text as a table. Throws FileError (corrupt).
[[nodiscard]] Columns parse_delimited_text(std::string bytes, const std::filesystem::path& name,
                                           const Wanted& wanted = {},
                                           const TextLayout& stated = {});

}  // namespace wheeltap::io
