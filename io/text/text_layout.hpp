// How a delimited text is laid out: as stated by its reader, and as found.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::io {

/// What is not stated is detected. Lines are counted from 1, in the file.
struct TextLayout {
  std::optional<char> separator = {};  ///< ',', ';', '\t', '|' or ' ' for any run of blanks
  std::optional<char> decimal = {};    ///< '.' or ','
  std::optional<int> skip = {};        ///< lines before anything that is looked at
  std::optional<int> header = {};      ///< line of the columns' names; 0: there is none
  std::optional<int> units_row = {};   ///< line of the columns' units; 0: there is none
  std::string time_format = {};        ///< of time stamps (io/text/time_stamp.hpp); empty: detected
  std::string sheet = {};              ///< of a workbook; empty: the first that is not hidden

  bool operator==(const TextLayout&) const = default;
};

struct HeadLine {
  int number = 0;
  std::string text = {};
};

/// What was found in a text.
struct FoundLayout {
  TextLayout used = {};  ///< every member is set; `time_format` where there are time stamps
  int columns = 0;
  int first_row = 0;       ///< line of the first row of numbers
  std::string start = {};  ///< the first time stamp
  /// Lines behind the rows that are no part of the table: the first and the last; 0 where there are
  /// none.
  int tail_from = 0, tail_to = 0;
  std::vector<HeadLine> above = {};  ///< lines above the rows, without the marks of comments
};

/// How a separator is written in cases and in sentences: "comma", "semicolon", "tab", "bar",
/// "blank".
[[nodiscard]] std::string_view separator_name(char separator);
/// The separator that this text states: its name, or itself (",", ";", "\t", "|", " ").
[[nodiscard]] std::optional<char> parse_separator(std::string_view text);

/// The lines of a text from which its layout is found.
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

/// What the sniffer says of a text: how its rows are split, and where they begin.
struct TableShape {
  char separator = ',';
  char decimal = '.';
  std::size_t columns = 0;
  std::size_t trailing = 0;  ///< rows may end with as many separators that separate nothing
  /// The last column holds remarks and may be missing, with its separator.
  bool optional_last = false;
  bool grouped = false;              ///< numbers have separators of thousands
  std::vector<CellKind> kinds = {};  ///< a column each
  std::size_t first = 0;             ///< index of the first row among the lines
  std::optional<std::size_t> names;  ///< index of the line of names
  std::optional<std::size_t> units;  ///< index of the line of units
  bool date_unnamed = false;   ///< of a date and a time in the first columns, names name the latter
  bool index_unnamed = false;  ///< names leave out the first column, which counts the rows
};

/// Whether a line could be remarks behind the rows: its first cell is neither a number nor a stamp.
[[nodiscard]] bool is_remark(std::string_view line, const TableShape& shape);

/// Why a text's layout cannot be found, and what would settle it.
struct UnclearLayout : std::runtime_error {
  UnclearLayout(int at, const std::string& reason) : std::runtime_error(reason), line(at) {}
  int line;  ///< 0: of the whole text
};

/// Finds how a text is laid out from its first lines and a sample of its later ones. `head` holds
/// all lines, comments included, before and some after the first row; `body` further rows. With
/// `header_first` the first line that is no comment holds the names. Throws UnclearLayout.
[[nodiscard]] TableShape find_shape(const std::vector<TextLine>& head,
                                    const std::vector<TextLine>& body, const TextLayout& stated,
                                    bool header_first);

}  // namespace wheeltap::io
