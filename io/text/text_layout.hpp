// The layout of a delimited text: as stated by the caller, and as detected.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

/// The layout as the caller states it. Options that are not set are detected. Line numbers start at
/// 1.
struct TextLayout {
  std::optional<char> separator = {};  ///< ',', ';', '\t', '|' or ' ' for any run of blanks
  std::optional<char> decimal = {};    ///< '.' or ','
  std::optional<int> skip = {};        ///< lines to skip before detection
  std::optional<int> header = {};      ///< line of the column names; 0: no such line
  std::optional<int> units_row = {};   ///< line of the column units; 0: no such line
  std::string time_format =
      {};                  ///< format of time stamps (io/text/time_stamp.hpp); empty: detected
  std::string sheet = {};  ///< a workbook's sheet; empty: the first that is not hidden

  bool operator==(const TextLayout&) const = default;
};

struct HeadLine {
  int number = 0;
  std::string text = {};
};

/// The detected layout of a text.
struct FoundLayout {
  TextLayout used = {};  ///< every member is set; `time_format` only if there are time stamps
  int columns = 0;
  int first_row = 0;       ///< line of the first row of numbers
  std::string start = {};  ///< the first time stamp
  /// First and last of the lines after the table that were ignored; 0 if there are none.
  int tail_from = 0, tail_to = 0;
  std::vector<HeadLine> above = {};  ///< lines above the rows, without comment marks
};

/// The name of a separator in cases and messages: "comma", "semicolon", "tab", "bar", "blank".
[[nodiscard]] std::string_view separator_name(char separator);
/// The separator from its name or the character itself (",", ";", "\t", "|", " ").
[[nodiscard]] std::optional<char> parse_separator(std::string_view text);

/// A line of text as input of the layout detection.
struct TextLine {
  std::string_view text;
  int number = 0;  ///< from 1
  bool is_comment = false;
};

enum class CellKind {
  number,  ///< or a missing value
  stamp,   ///< a date or time of day
  text
};

/// Result of the detection: how rows are split, and where they begin.
struct TableShape {
  char separator = ',';
  char decimal = '.';
  std::size_t columns = 0;
  std::size_t trailing = 0;  ///< number of separators at the end of rows without a cell after them
  /// True if the last column holds remarks; its cell and separator may be missing in a row.
  bool optional_last = false;
  bool grouped = false;              ///< numbers have thousands separators
  std::vector<CellKind> kinds = {};  ///< one per column
  std::size_t first = 0;             ///< index of the first row among the lines
  std::optional<std::size_t> names;  ///< index of the line of names
  std::optional<std::size_t> units;  ///< index of the line of units
  bool date_unnamed = false;   ///< the first columns are a date and a time, and the line of names
                               ///< names only the time
  bool index_unnamed = false;  ///< the line of names omits the first column, which numbers the rows
};

/// True if a line could be a remark after the rows: its first cell is neither a number nor a stamp.
[[nodiscard]] bool is_remark(std::string_view line, const TableShape& shape);

/// The error for a layout that cannot be detected, with the reason and the option that resolves it.
struct UnclearLayout : std::runtime_error {
  UnclearLayout(int at, const std::string& reason) : std::runtime_error(reason), line(at) {}
  int line;  ///< 0: the whole text
};

/// Detects the layout of a text from its first lines and a sample of later ones. `head` holds all
/// lines, comments included, before the first row and some after it; `body` further rows. With
/// `header_first` the first line that is not a comment holds the names. Throws UnclearLayout.
[[nodiscard]] TableShape find_shape(const std::vector<TextLine>& head,
                                    const std::vector<TextLine>& body, const TextLayout& stated,
                                    bool header_first);

}  // namespace wheeltap::io
