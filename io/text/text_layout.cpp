#include "io/text/text_layout.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <span>
#include <utility>

#include "io/text/text_cells.hpp"
#include "io/text/text_number.hpp"
#include "io/text/text_split.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::io {
namespace {

constexpr std::array kSeparators = {',', ';', '\t', '|', ' '};
constexpr std::size_t kMostHeaderLines = 8;  // lines between the names and the first row

class Finder {
 public:
  Finder(const std::vector<TextLine>& head, const std::vector<TextLine>& body,
         const TextLayout& stated, bool header_first)
      : head_(head), body_(body), stated_(stated), header_first_(header_first) {
    reading_.grouped = stated.decimal.has_value();
    if (!stated.time_format.empty()) reading_.format = parse_time_format(stated.time_format);
  }

  TableShape find() {
    choose_separator();
    count_columns();
    settle_commas();
    compare_marks();
    if (!rows_.empty()) check_quoted_commas();
    find_kinds();
    find_first_row();
    find_names();
    return std::move(out_);
  }

 private:
  [[nodiscard]] Split split_line(const TextLine& line) const {
    return split(line.text, out_.separator, reading_);
  }

  void choose_separator() {
    std::vector<TextLine> sample;
    // Use later rows of a long text, because they contain no headers.
    if (body_.empty()) {
      sample = head_;
      if (header_first_) {
        const auto first = std::ranges::find(sample, false, &TextLine::is_comment);
        if (first != sample.end()) sample.erase(first);
      }
    } else {
      sample = body_;
    }
    long best = -1;
    for (const char separator : kSeparators) {
      if (stated_.separator && *stated_.separator != separator) continue;
      for (const char decimal : {'.', ','}) {
        if (stated_.decimal && *stated_.decimal != decimal) continue;
        // A comma can be separator and decimal mark at once only if numbers are quoted.
        if (separator == decimal && stated_.separator) continue;
        Reading reading = reading_;
        reading.decimal = decimal;
        const long cells = explained_cells(sample, separator, reading);
        if (cells <= best) continue;
        best = cells;
        out_.separator = separator;
        out_.decimal = decimal;
      }
    }
    if (best < 0)
      throw UnclearLayout(0, "a comma cannot both separate columns and be the decimal mark");
    reading_.decimal = out_.decimal;
    if (best > 0 || stated_.separator) return;
    // The text contains no numbers: use the line of names.
    std::size_t most = 0;
    for (const TextLine& line : head_) {
      if (line.is_comment) continue;
      for (const char separator : {',', ';', '\t'})
        if (const std::size_t count = loose_cells(line.text, separator).size(); count > most + 1) {
          most = count - 1;
          out_.separator = separator;
        }
      break;
    }
  }

  void count_columns() {
    rows_.clear();
    std::map<std::size_t, std::size_t> counts;
    // Rows with texts count only if the text has no other rows.
    for (const bool mixed : {false, true}) {
      bool is_header = header_first_;
      for (const std::vector<TextLine>* lines : {&head_, &body_}) {
        for (const TextLine& line : *lines) {
          if (line.is_comment || std::exchange(is_header, false)) continue;
          Split s = split_line(line);
          const bool counts_as_row =
              mixed ? s.numbers + s.stamps > 0 && s.numbers + s.stamps >= s.texts : s.is_row();
          if (!counts_as_row) continue;
          ++counts[s.cells.size()];
          rows_.push_back(std::move(s));
        }
      }
      if (!rows_.empty()) break;
    }
    if (rows_.empty()) return;
    std::size_t most = 0;
    for (const auto& [cells, count] : counts) most = std::max(most, count);
    const std::optional<std::size_t> named = cells_above_rows();
    for (const Split& row : rows_) {
      if (counts[row.cells.size()] != most) continue;
      out_.columns = row.cells.size();
      break;
    }
    // If two row lengths are equally frequent, choose the length that fits the names.
    if (named && counts.contains(*named) && counts[*named] == most) out_.columns = *named;
    // Do not count cells at the end that are empty in all rows of this length, unless they have
    // names.
    out_.trailing = out_.columns - 1;
    for (const Split& row : rows_)
      if (row.cells.size() == out_.columns) out_.trailing = std::min(out_.trailing, row.trailing);
    if (named && *named <= out_.columns && *named + out_.trailing > out_.columns)
      out_.trailing = out_.columns - *named;
    out_.columns -= out_.trailing;
    // "a,b,c" over "1,2": rows without the last cell and its separator, a column of remarks.
    if (named && *named == out_.columns + 1 && is_remarks_name(last_name_)) {
      ++out_.columns;
      out_.optional_last = true;
    }
  }

  /// Returns the number of cells in the last line before the first row.
  std::optional<std::size_t> cells_above_rows() {
    std::optional<std::size_t> found;
    for (const TextLine& line : head_) {
      if (line.is_comment) continue;
      const Split s = split_line(line);
      if (is_data(s) && !(header_first_ && !found)) break;
      const std::vector<std::string> names = joined(s.cells);
      found = names.size() - std::min(s.trailing, names.size() - 1);
      last_name_ = names.at(*found - 1);
    }
    return found;
  }

  /// True for a row, which may contain texts: the first cell is a number or a time stamp, and so
  /// are most other cells.
  [[nodiscard]] bool is_data(const Split& s) const {
    if (s.is_row()) return true;
    const auto first =
        std::ranges::find_if(s.cells, [](const std::string& cell) { return !cell.empty(); });
    if (first == s.cells.end() || is_missing_value(*first)) return false;
    return kind_of(*first, reading_) != CellKind::text && s.numbers + s.stamps > 1 &&
           s.numbers + s.stamps >= s.texts;
  }

  [[nodiscard]] std::vector<std::string> joined(const std::vector<std::string>& cells) const {
    return out_.separator == ' ' ? joined_names(cells) : cells;
  }

  /// Rejects quoted numbers like "1,234" in a text separated by commas: the meaning is ambiguous.
  void check_quoted_commas() {
    if (out_.separator != out_.decimal || stated_.decimal) return;
    for (const Split& row : rows_)
      for (const std::string& cell : row.cells)
        if (cell.find(',') != std::string::npos && !parse_grouped_number(cell, '.', true)) return;
    const auto first = std::ranges::find_if(
        head_, [&](const TextLine& l) { return !l.is_comment && split_line(l).is_row(); });
    throw UnclearLayout(first == head_.end() ? 0 : first->number,
                        "commas within quotes may be decimal marks or separate thousands. State "
                        "\"decimal\": \",\" for decimal commas, or \"decimal\": \".\" for "
                        "thousands");
  }

  /// Rejects "a,b" over "0,1 2": the comma separates names, but would be a decimal mark in rows.
  void compare_marks() {
    if (out_.decimal != ',' || out_.columns < 2 || stated_.decimal || header_first_) return;
    std::optional<std::size_t> names;
    for (std::size_t i = 0; i < head_.size(); ++i) {
      if (head_[i].is_comment) continue;
      if (!is_data(split_line(head_[i]))) {
        names = i;
        continue;
      }
      if (!names) return;
      const std::string_view line = head_[*names].text;
      if (line.find(out_.separator == ' ' ? '\t' : out_.separator) != std::string_view::npos)
        return;
      const auto by_comma = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
      if (by_comma < 2 || joined(loose_cells(line, out_.separator)).size() == out_.columns) return;
      throw UnclearLayout(
          head_[i].number,
          "commas separate the names in line " + std::to_string(head_[*names].number) +
              ", and could be decimal marks or separators here. State \"decimal\": \",\" if they "
              "are decimal marks, or \"separator\": \",\" if they separate columns");
    }
  }

  void settle_commas() {
    if (out_.separator != ',' || out_.decimal != '.' || stated_.separator || stated_.decimal ||
        out_.trailing)
      return;
    std::size_t names = 0;
    int line = 0;
    for (const TextLine& l : head_) {
      if (l.is_comment) continue;
      if (!(header_first_ && names == 0) && split_line(l).is_row()) {
        line = l.number;
        break;
      }
      names = loose_cells(l.text, ',').size();
    }
    switch (commas_of(rows_, out_.columns, names)) {
      case Commas::separate:
        return;
      case Commas::decimal:
        out_.separator = ';';
        out_.decimal = reading_.decimal = ',';
        count_columns();
        return;
      case Commas::unclear:
        throw UnclearLayout(
            line,
            "a comma between whole numbers may separate two columns or be a decimal "
            "comma. State \"decimal\": \",\" for decimal commas, or "
            "\"separator\": \",\" for two columns");
      case Commas::mixed:
        throw UnclearLayout(line,
                            "commas are decimal marks and column separators, so the numbers are "
                            "ambiguous. Export the file with semicolons or "
                            "tabs between columns, or state \"separator\": \",\" if no comma is a "
                            "decimal comma");
    }
  }

  void find_kinds() {
    std::vector<std::array<std::size_t, 3>> counts(out_.columns);
    for (const Split& row : rows_)
      for (std::size_t c = 0; c < std::min(out_.columns, row.cells.size()); ++c)
        if (!is_missing_value(row.cells[c]))
          ++counts[c][static_cast<std::size_t>(kind_of(row.cells[c], reading_))];
    // The kind of a column is the kind of most of its cells.
    for (const auto& count : counts) {
      CellKind kind = CellKind::number;
      if (count[1] > count[0]) kind = CellKind::stamp;
      if (count[2] > count[0] + count[1]) kind = CellKind::text;
      out_.kinds.push_back(kind);
    }
    if (rows_.empty() || header_first_) return;
    // A column of remarks without any number may hold texts in a few rows.
    std::vector<bool> filled(out_.columns, false);
    for (const Split& row : rows_)
      for (std::size_t c = 0; c < std::min(out_.columns, row.cells.size()); ++c)
        filled[c] = filled[c] || !row.cells[c].empty();
    for (std::size_t c = 0; c < out_.columns; ++c)
      if (!filled[c] && out_.columns > 1) out_.kinds[c] = CellKind::text;
    for (const Split& row : rows_)
      for (const std::string& cell : row.cells)
        reading_.grouped = reading_.grouped || parse_grouped_number(cell, out_.decimal).has_value();
    out_.grouped = reading_.grouped;
  }

  [[nodiscard]] bool fits(const Split& s) const {
    if (!has_length(s) || s.numbers + s.stamps == 0) return false;
    for (std::size_t c = 0; c < std::min(out_.columns, s.cells.size()); ++c) {
      if (out_.kinds[c] == CellKind::text || s.cells[c].empty()) continue;
      if (kind_of(s.cells[c], reading_) == CellKind::text) return false;
    }
    return true;
  }

  [[nodiscard]] bool has_length(const Split& s) const {
    return (s.cells.size() >= out_.columns &&
            s.cells.size() - out_.columns <= std::min(out_.trailing, s.trailing)) ||
           (out_.optional_last && s.cells.size() + 1 == out_.columns);
  }

  void find_first_row() {
    out_.first = head_.size();
    for (std::size_t i = 0; i < head_.size(); ++i) {
      if (head_[i].is_comment) continue;
      if (header_first_) {
        // The names are stated to be in the first line that is not a comment.
        out_.names = i;
        out_.first = i + 1;
        return;
      }
      const Split s = split_line(head_[i]);
      if (rows_.empty() || !fits(s)) continue;
      out_.first = i;
      break;
    }
    // Include rows above the first row if they are data rows and not a line of names.
    while (out_.first > 0 && out_.first < head_.size()) {
      const TextLine& above = head_[out_.first - 1];
      if (above.is_comment) break;
      const Split s = split_line(above);
      if (!has_length(s) || !is_data(s)) break;
      --out_.first;
    }
  }

  /// Returns the cells of a line as column names, or an empty list if their number differs from the
  /// number of columns.
  [[nodiscard]] std::vector<std::string> as_names(const TextLine& line) const {
    const std::string_view bare = without_comment_mark(line.text);
    std::vector<std::string> names = names_in(line.text, out_.separator, out_.columns);
    if (bare.size() == line.text.size()) return names;
    // An empty first cell looks like a mark.
    if (!line.is_comment && !names.empty() && line.text.front() == out_.separator) return names;
    std::vector<std::string> bare_names = names_in(bare, out_.separator, out_.columns);
    return bare_names.empty() && !line.is_comment ? names : bare_names;
  }

  void find_names() {
    if (header_first_) return;
    const auto by_number = [&](int number) -> std::optional<std::size_t> {
      for (std::size_t i = 0; i < out_.first; ++i)
        if (head_[i].number == number) return i;
      return std::nullopt;
    };
    const bool names_stated = stated_.header.has_value();
    if (names_stated && *stated_.header > 0) {
      // The rows begin below the line of names, whatever this line contains.
      for (std::size_t i = 0; i < head_.size(); ++i)
        if (head_[i].number == *stated_.header) {
          out_.names = i;
          out_.first = std::max(out_.first, i + 1);
        }
      if (!out_.names)
        throw UnclearLayout(*stated_.header,
                            "\"header\": " + std::to_string(*stated_.header) +
                                " must be the number of a nonempty line above the rows");
    }
    if (stated_.units_row && *stated_.units_row > 0) {
      out_.units = by_number(*stated_.units_row);
      if (!out_.units)
        throw UnclearLayout(*stated_.units_row,
                            "\"units_row\": " + std::to_string(*stated_.units_row) +
                                " must be the number of a nonempty line above the rows");
    }
    while (out_.first < head_.size() &&
           (head_[out_.first].is_comment || (out_.units && out_.first <= *out_.units)))
      ++out_.first;
    if (names_stated) {
      if (!out_.units && !stated_.units_row && out_.names) {
        for (std::size_t i = *out_.names + 1; i < out_.first; ++i)
          if (!head_[i].is_comment && is_units_line(loose_cells(head_[i].text, out_.separator))) {
            out_.units = i;
            break;
          }
      }
      return;
    }
    find_block();
    if (!out_.names) find_comment();
  }

  /// Finds names and units among the lines directly above the rows.
  void find_block() {
    std::vector<std::size_t> block;  // from bottom to top
    std::vector<std::vector<std::string>> cells;
    for (std::size_t i = out_.first; i-- > 0 && block.size() < kMostHeaderLines;) {
      const TextLine& line = head_[i];
      if (line.is_comment) continue;
      if (out_.units && i == *out_.units) continue;
      std::vector<std::string> names = as_names(line);
      if (names.empty()) break;
      block.push_back(i);
      cells.push_back(std::move(names));
    }
    if (block.empty()) {
      wrong_header();
      return;
    }
    std::optional<std::size_t> units;  // index in the block
    if (!out_.units && stated_.units_row.value_or(-1) != 0)
      for (std::size_t b = 0; b < block.size() && !units; ++b)
        if (is_units_line(cells[b])) units = b;
    // If there is one line of names, the line of units may also be directly above this line.
    if (units == 1U && block.size() == 2 && can_name(cells[0])) {
      out_.units = block[1];
      out_.names = block[0];
      return;
    }
    // A line of units is below a line of names. Without a line above it that can have names, it is
    // itself the line of names.
    if (units && (*units + 1 == block.size() || !can_name(cells[*units + 1]))) units.reset();
    if (units) out_.units = block[*units];
    std::size_t names = units ? *units + 1 : 0;
    // A line with empty cells is not the line of names if the line above it has fewer empty cells.
    while (!units && names + 1 < block.size() && filled(cells[names]) < out_.columns &&
           filled(cells[names + 1]) > filled(cells[names]))
      ++names;
    out_.names = block[names];
  }

  /// Numbers are not names, except channel numbers: "x-axis,1,2".
  [[nodiscard]] bool can_name(const std::vector<std::string>& cells) const {
    const auto is_text = [&](const std::string& cell) {
      return is_missing_value(cell) || kind_of(cell, reading_) == CellKind::text;
    };
    if (std::ranges::any_of(cells, [](const std::string& c) { return c.starts_with(':'); }))
      return false;
    return std::ranges::all_of(cells, is_text) ||
           (cells.size() > 1 && is_text(cells.front()) && !is_missing_value(cells.front()) &&
            std::all_of(cells.begin() + 1, cells.end(), all_digits));
  }

  /// Selects as line of names a line above the rows whose number of cells differs from the number
  /// of columns. For two known patterns, the missing names are recorded. For any other line, the
  /// check of the number of names fails later.
  void wrong_header() {
    if (out_.first == 0 || out_.first >= head_.size()) return;
    std::size_t above = out_.first - 1;
    while (above > 0 && head_[above].is_comment) --above;
    if (head_[above].is_comment || head_[above].number + 1 != head_[out_.first].number) return;
    const std::vector<std::string> cells = joined(loose_cells(head_[above].text, out_.separator));
    // "Time a b" over "2021-03-01 10:00:00 1 2": date and time have one name together.
    if (cells.size() + 1 == out_.columns && out_.separator == ' ' &&
        out_.kinds[0] == CellKind::stamp && out_.kinds[1] == CellKind::stamp) {
      out_.names = above;
      out_.date_unnamed = true;
      return;
    }
    if (cells.size() < 2 || out_.separator == ' ') {
      if (out_.columns != 1) return;
      out_.names = above;
      return;
    }
    // R omits the name of its column of row names.
    if (cells.size() + 1 == out_.columns && first_column_counts()) {
      out_.names = above;
      out_.index_unnamed = true;
      return;
    }
    out_.names = above;
  }

  [[nodiscard]] bool first_column_counts() const {
    if (out_.kinds.front() == CellKind::text) return true;
    double expected = -1.0;
    for (const Split& row : rows_) {
      const std::optional<double> value = parse_number(row.cells.front());
      if (!value || (expected >= 0.0 && *value != expected)) return false;
      if (expected < 0.0 && *value != 0.0 && *value != 1.0) return false;
      expected = *value + 1.0;
    }
    return rows_.size() > 1;
  }

  /// "# t a1 a2": names in the last comment before the rows.
  void find_comment() {
    if (stated_.header && *stated_.header == 0) return;
    std::vector<std::size_t> comments;
    for (std::size_t i = out_.first; i-- > 0 && comments.size() < 3;)
      if (head_[i].is_comment) comments.push_back(i);
    std::optional<std::size_t> units;
    for (const std::size_t i : comments) {
      const std::string_view text = without_comment_mark(head_[i].text);
      const std::vector<std::string> names = as_names(head_[i]);
      if (names.empty()) continue;
      if (std::ranges::any_of(names, [&](const std::string& n) {
            return n.ends_with(':') || parse_number(n, out_.decimal).has_value();
          }))
        continue;
      // With one column, a remark is not a name.
      if (out_.columns == 1 && text.find(' ') != std::string_view::npos && !text.ends_with(']') &&
          !text.ends_with(')'))
        continue;
      if (is_units_line(names) && !units && !out_.units) {
        units = i;
        continue;
      }
      out_.names = i;
      if (units) out_.units = units;
      return;
    }
  }

  const std::vector<TextLine>& head_;
  const std::vector<TextLine>& body_;
  const TextLayout& stated_;
  bool header_first_;
  Reading reading_;
  TableShape out_;
  std::vector<Split> rows_;
  std::string last_name_;
};

}  // namespace

std::string_view separator_name(char separator) {
  switch (separator) {
    case ',':
      return "comma";
    case ';':
      return "semicolon";
    case '\t':
      return "tab";
    case '|':
      return "bar";
    default:
      return "blank";
  }
}

std::optional<char> parse_separator(std::string_view text) {
  for (const char separator : kSeparators)
    if (text == separator_name(separator) || text == std::string_view(&separator, 1))
      return separator;
  if (text == "\\t") return '\t';
  if (text == "space") return ' ';
  return std::nullopt;
}

bool is_remark(std::string_view line, const TableShape& shape) {
  const std::vector<std::string> cells = loose_cells(line, shape.separator);
  const auto first =
      std::ranges::find_if(cells, [](const std::string& cell) { return !cell.empty(); });
  if (first == cells.end()) return true;
  if (is_missing_word(*first) || cells.size() == shape.columns) return false;
  return kind_of(*first, {.decimal = shape.decimal}) == CellKind::text &&
         first->find_first_not_of("+-.,0123456789eE") != std::string::npos;
}

TableShape find_shape(const std::vector<TextLine>& head, const std::vector<TextLine>& body,
                      const TextLayout& stated, bool header_first) {
  return Finder(head, body, stated, header_first).find();
}

}  // namespace wheeltap::io
