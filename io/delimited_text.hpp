// Tables as text, one row a line: the one grammar for all that we read.
//
//   file   = [byte order mark] line…              lines end with LF, CR LF or CR
//   line   = blanks | "#" anything | row          the first two are no rows
//   row    = cell (separator cell)…
//   cell   = blanks text blanks | blanks '"' text with "" for " '"' blanks
//   number = [+|-] digits [. digits] [e [+|-] digits] | nan | inf; an empty cell is NaN
//
// A text that is not UTF-8 is taken for Latin-1, cell by cell.
//
// The separator is the comma, semicolon or tab that the first row has most of. Where it has none,
// and the first line of numbers holds several, it is any run of blanks. A first row with a cell
// that is no number is a header: "force [N]" (see io/columns.hpp). What cells must hold, and
// whether rows may be short, is the reader's to say.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/columns.hpp"

namespace wheeltap::io {

/// The number that this text is, all of it; empty text is none. The nearest double, as
/// std::from_chars has it; text beyond the range of doubles is none.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

enum class FirstRow {
  detected,  ///< a header where one of its cells is no number
  header
};

/// The lines of a text, split on demand.
class DelimitedText {
 public:
  /// Throws FileError (corrupt) for what is no such text: a NUL byte, UTF-16, a header with a quote
  /// that is not closed. `name` stands for the file in messages.
  DelimitedText(std::string bytes, std::filesystem::path name,
                FirstRow first_row = FirstRow::detected);

  /// One a column, without values; of a file without a header they are called "1", "2", …
  [[nodiscard]] const std::vector<Column>& headers() const { return headers_; }
  [[nodiscard]] int header_line() const { return header_line_; }  ///< 0: there is none
  [[nodiscard]] int rows() const { return static_cast<int>(starts_.size()); }
  /// Line of a row, from 1; that after the last for `rows()`.
  [[nodiscard]] int line(int row) const;
  /// The cells of a row, trimmed and without their quotes. Throws FileError (corrupt) for a quote
  /// that is not closed, or text after one.
  [[nodiscard]] std::vector<std::string> cells(int row) const;

  /// All rows as numbers; columns that are not wanted may hold anything. Rows are then samples: an
  /// empty line between them is refused, as is a row of another length. Throws FileError (corrupt),
  /// with the line and column.
  [[nodiscard]] Columns columns(const Wanted& wanted = {}) const;

 private:
  [[nodiscard]] std::string_view line_at(std::size_t start) const;
  /// A cell without its blanks and quotes.
  [[nodiscard]] std::string content(std::string_view raw, const Place& place) const;
  [[nodiscard]] std::vector<std::string> split(std::string_view line, int number) const;
  [[noreturn]] void fail(Place place, const std::string& reason) const;
  void choose_separator(std::string_view first, std::string_view second, FirstRow first_row);

  std::string text_;
  std::filesystem::path name_;
  char newline_ = '\n';
  char separator_ = ',';  ///< ' ' for any run of blanks
  int header_line_ = 0;
  int first_line_ = 0;
  int empty_line_ = 0;  ///< the first between rows; 0: none
  std::vector<Column> headers_;
  std::vector<std::size_t> starts_;  ///< of the rows, in the text
  std::vector<int> skipped_;         ///< rows before which a line stands that is none
};

/// The table that a delimited text is. Throws FileError (corrupt).
[[nodiscard]] Columns parse_delimited_text(std::string bytes, const std::filesystem::path& name,
                                           const Wanted& wanted = {});

}  // namespace wheeltap::io
