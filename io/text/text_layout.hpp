// The layout of a delimited text: as stated by the caller, and as detected.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

/// The layout of a text as stated by the caller. If an option is not set, its value is detected.
/// Line numbers start at 1.
struct TextLayout {
  std::optional<char> separator = {};  ///< ',', ';', '\t', '|', or ' ' for runs of blanks
  std::optional<char> decimal = {};    ///< decimal mark: '.' or ','
  std::optional<int> skip = {};        ///< number of lines to skip before detection
  std::optional<int> header = {};      ///< line number of the column names; 0: no names
  std::optional<int> units_row = {};   ///< line number of the column units; 0: no units
  std::string time_format =
      {};                  ///< format of time stamps (io/text/time_stamp.hpp); empty: detected
  std::string sheet = {};  ///< sheet of a workbook; empty: the first sheet that is not hidden

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
  int first_row = 0;            ///< line of the first row of numbers
  std::string start = {};       ///< the first time stamp
  bool start_has_zone = false;  ///< TimeStamp::has_zone of the first time stamp
  /// First and last ignored line after the table; 0 if no line was ignored.
  int tail_from = 0, tail_to = 0;
  std::vector<HeadLine> above = {};  ///< lines above the first row, without comment marks
};

/// The name of a separator in cases and messages: "comma", "semicolon", "tab", "bar", "blank".
[[nodiscard]] std::string_view separator_name(char separator);
/// Converts the name of a separator, or the character itself (",", ";", "\t", "|", " "), to the
/// separator.
[[nodiscard]] std::optional<char> parse_separator(std::string_view text);

/// A line of text, as input of the layout detection.
struct TextLine {
  std::string_view text;
  int number = 0;  ///< number of the line, from 1
  bool is_comment = false;
};

enum class CellKind {
  number,  ///< a number or a missing value
  stamp,   ///< a date or time of day
  text
};

/// Result of the layout detection: the rules for splitting rows into cells, and the first
/// row.
struct TableShape {
  char separator = ',';
  char decimal = '.';
  std::size_t columns = 0;
  std::size_t trailing = 0;  ///< number of final separators that no cell follows
  /// True if the last column holds remarks. The cell and the separator of this column may be
  /// missing in a row.
  bool optional_last = false;
  bool grouped = false;              ///< numbers have thousands separators
  std::vector<CellKind> kinds = {};  ///< one per column
  std::size_t first = 0;             ///< index of the first row among the lines
  std::optional<std::size_t> names;  ///< index of the line of names
  std::optional<std::size_t> units;  ///< index of the line of units
  bool date_unnamed = false;         ///< the first columns are date and time; the line of names
                                     ///< names the time only
  bool index_unnamed = false;  ///< the first column numbers the rows and has no name in the line of
                               ///< names
};

/// True if a line could be a remark after the rows, because its first cell is neither a number nor
/// a time stamp.
[[nodiscard]] bool is_remark(std::string_view line, const TableShape& shape);

/// The error for a layout that cannot be detected. The message gives the reason and the option that
/// resolves the ambiguity.
struct UnclearLayout : std::runtime_error {
  UnclearLayout(int at, const std::string& reason) : std::runtime_error(reason), line(at) {}
  int line;  ///< line number; 0: the whole text
};

/// Detects the layout of a text from its first lines and a sample of later lines. `head` holds all
/// lines before the first row, comments included, and some lines after the first row. `body` holds
/// further rows. If `header_first` is true, the first line that is not a comment holds the names.
/// Throws UnclearLayout.
[[nodiscard]] TableShape find_shape(const std::vector<TextLine>& head,
                                    const std::vector<TextLine>& body, const TextLayout& stated,
                                    bool header_first);

}  // namespace wheeltap::io
