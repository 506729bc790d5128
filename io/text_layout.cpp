#include "io/text_layout.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <span>
#include <utility>

#include "io/text.hpp"
#include "io/text_number.hpp"
#include "io/time_stamp.hpp"

namespace wheeltap::io {
namespace {

constexpr std::array kSeparators = {',', ';', '\t', '|', ' '};
constexpr std::size_t kMostHeaderLines = 8;  // between the names and the first row

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}

std::string_view without_sign(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  return text;
}

/// "20210301100000": digits that are rather a date.
bool is_long_stamp(std::string_view cell) {
  const std::size_t digits = std::min(cell.find_first_not_of("0123456789"), cell.size());
  return (digits == 14 || digits == 17) && (cell[0] == '1' || cell[0] == '2') &&
         read_stamp(cell).stamp;
}

/// How cells are understood.
struct Reading {
  char decimal = '.';
  bool grouped = false;  ///< that commas or points part thousands is stated or proven
  std::optional<TimeFormat> format = {};
};

CellKind kind_of(std::string_view cell, const Reading& reading) {
  const std::optional<TimeFormat>& format = reading.format;
  if (is_missing_value(cell)) return CellKind::number;
  if (!is_long_stamp(cell) && (parse_number(cell, reading.decimal) ||
                               parse_grouped_number(cell, reading.decimal, reading.grouped)))
    return CellKind::number;
  if (format && !format->pattern.empty())
    return read_stamp(cell, format->pattern) ? CellKind::stamp : CellKind::text;
  const StampReading stamp = read_stamp(cell, format ? format->order : DayOrder::unknown);
  return stamp.stamp || stamp.ambiguous ? CellKind::stamp : CellKind::text;
}

/// A line, split in one way.
struct Split {
  std::vector<std::string> cells;
  std::size_t numbers = 0, stamps = 0, texts = 0;
  std::size_t trailing = 0;  ///< how many of the last cells are empty

  [[nodiscard]] bool is_row() const { return texts == 0 && numbers + stamps > 0; }
};

Split split(std::string_view line, char separator, const Reading& reading) {
  Split out{.cells = loose_cells(line, separator)};
  for (const std::string& cell : out.cells) {
    const CellKind kind = kind_of(cell, reading);
    if (kind == CellKind::text) ++out.texts;
    if (kind == CellKind::stamp) ++out.stamps;
    if (kind == CellKind::number && !is_missing_value(cell)) ++out.numbers;
  }
  while (out.trailing + 1 < out.cells.size() &&
         out.cells[out.cells.size() - 1 - out.trailing].empty())
    ++out.trailing;
  return out;
}

/// How well a separator and a decimal mark explain lines: twice the numbers and stamps of lines
/// that hold nothing else; of the others by how many they are more than the texts.
long explained_cells(std::span<const TextLine> lines, char separator, const Reading& reading) {
  long out = 0;
  for (const TextLine& line : lines) {
    if (line.is_comment) continue;
    const Split s = split(line.text, separator, reading);
    const auto found = static_cast<long>(s.numbers + s.stamps);
    out += s.is_row() ? 2 * found : std::max(0L, found - static_cast<long>(s.texts));
  }
  return out;
}

/// What commas in the cells of rows of whole numbers are.
enum class Commas { separate, decimal, unclear, mixed };

/// Rows "0,1108" may be two whole numbers or one number. `names`: columns that the header names; 0
/// where there is none.
Commas commas_of(const std::vector<Split>& rows, std::size_t columns, std::size_t names) {
  if (columns < 2 || columns % 2 != 0 || rows.empty()) return Commas::separate;
  bool leading_zero = false;
  std::vector<bool> zero_in(columns / 2, false);
  for (const Split& row : rows) {
    if (row.cells.size() != columns) continue;
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string_view cell = row.cells[c];
      if (c % 2 == 0 && !all_digits(without_sign(cell))) return Commas::separate;
      if (c % 2 == 0 && (cell == "-0" || cell == "+0")) zero_in[c / 2] = true;
      if (c % 2 == 0) continue;
      // The exponent stays with the digits behind the comma.
      const std::string_view digits = cell.substr(0, cell.find_first_of("eE"));
      if (!all_digits(digits)) return Commas::separate;
      if (digits.size() > 1 && digits.front() == '0') zero_in[c / 2] = true;
    }
  }
  leading_zero = std::ranges::all_of(zero_in, [](bool zero) { return zero; });
  if (names == columns) return Commas::separate;
  if (names * 2 == columns) return columns == 2 ? Commas::decimal : Commas::mixed;
  if (names > 0) return Commas::separate;
  if (leading_zero) return columns == 2 ? Commas::decimal : Commas::mixed;
  if (columns > 2) return Commas::separate;
  // A first column that counts is an index or a time.
  if (rows.size() >= 5) {
    const auto first = [&](std::size_t row) {
      return parse_number(rows[row].cells.front()).value_or(0.0);
    };
    const double step = first(1) - first(0);
    bool counts = step != 0.0;
    for (std::size_t row = 2; row < rows.size() && counts; ++row)
      counts = first(row) - first(row - 1) == step;
    if (counts) return Commas::separate;
  }
  return Commas::unclear;
}

/// "TS" and "RN" stand in the line of units of Campbell's loggers.
bool is_neutral(std::string_view cell) {
  return cell.empty() || cell == "-" || cell == "TS" || cell == "RN" || cell == "[-]" ||
         cell == "(-)" || cell == "[]" || cell == "()";
}

/// "Unit;s;g": what the line holds, in front of it.
bool is_units_label(std::string_view cell) {
  std::string low = lower(cell);
  if (low.ends_with(':')) low.pop_back();
  return low == "unit" || low == "units" || low == "einheit" || low == "einheiten" ||
         low == "unité" || low == "unités" || low == "unidad";
}

bool is_units_line(const std::vector<std::string>& cells) {
  std::size_t units = 0;
  for (const std::string& cell : cells) {
    if (is_neutral(cell)) continue;
    if (&cell == &cells.front() && is_units_label(cell)) continue;
    if (!spells_unit(cell)) return false;
    ++units;
  }
  return units > 0;
}

std::size_t filled(const std::vector<std::string>& cells) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cells, [](const std::string& cell) { return !cell.empty(); }));
}

bool is_open(std::string_view header) {
  return std::ranges::count(header, '[') > std::ranges::count(header, ']') ||
         std::ranges::count(header, '(') > std::ranges::count(header, ')');
}

std::vector<std::string> joined_names(const std::vector<std::string>& cells) {
  std::vector<std::string> out;
  for (const std::string& cell : cells) {
    const bool joins =
        !out.empty() && (cell.starts_with('[') || cell.starts_with('(') || is_open(out.back()));
    if (joins) {
      out.back() += " " + cell;
    } else {
      out.push_back(cell);
    }
  }
  return out;
}

/// Cells between runs of two blanks or more.
std::vector<std::string> wide_cells(std::string_view line) {
  std::vector<std::string> out;
  line = trimmed(line);
  while (!line.empty()) {
    std::size_t end = std::min(line.find("  "), line.find('\t'));
    end = std::min(end, line.size());
    out.push_back(in_utf8(trimmed(line.substr(0, end))));
    line = trimmed(line.substr(end));
  }
  return out;
}

/// Names of a column of remarks, whose cells most rows leave out.
bool is_remarks_name(std::string_view name) {
  const std::string low = lower(name);
  for (const std::string_view known :
       {"comment", "comments", "remark", "remarks", "note", "notes", "bemerkung", "bemerkungen",
        "kommentar", "kommentare", "commentaire", "event", "events", "marker", "markers",
        "annotation", "annotations", "status"})
    if (low == known) return true;
  return false;
}

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
    // Where there are many rows the later ones are free of headers.
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
        // Quoted numbers may hold the separator.
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
    // No number anywhere: by the names.
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
    // Rows that are mixed with texts count where there are no others.
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
    // Of as many rows of either length, those are right that fit the names.
    if (named && counts.contains(*named) && counts[*named] == most) out_.columns = *named;
    // Empty cells at the end of all rows of this length are none, unless the names have them.
    out_.trailing = out_.columns - 1;
    for (const Split& row : rows_)
      if (row.cells.size() == out_.columns) out_.trailing = std::min(out_.trailing, row.trailing);
    if (named && *named <= out_.columns && *named + out_.trailing > out_.columns)
      out_.trailing = out_.columns - *named;
    out_.columns -= out_.trailing;
    // "a,b,c" over "1,2": a column of remarks without its separator.
    if (named && *named == out_.columns + 1 && is_remarks_name(last_name_)) {
      ++out_.columns;
      out_.optional_last = true;
    }
  }

  /// Of the last line before the first row.
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

  /// A row, or one with a text in it: it begins with a number or a stamp, as most of its cells are.
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

  /// "1,234" within quotes, between commas.
  void check_quoted_commas() {
    if (out_.separator != out_.decimal || stated_.decimal) return;
    for (const Split& row : rows_)
      for (const std::string& cell : row.cells)
        if (cell.find(',') != std::string::npos && !parse_grouped_number(cell, '.', true)) return;
    const auto first = std::ranges::find_if(
        head_, [&](const TextLine& l) { return !l.is_comment && split_line(l).is_row(); });
    throw UnclearLayout(first == head_.end() ? 0 : first->number,
                        "commas within quotes are decimal marks or part thousands. State "
                        "\"decimal\": \",\" for decimal commas, or \"decimal\": \".\" for "
                        "thousands");
  }

  /// "a,b" over "0,1 2": a comma between names that would be a decimal mark in the rows.
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
        throw UnclearLayout(line,
                            "a comma stands between whole numbers: they are two columns, or the "
                            "digits of one number. State \"decimal\": \",\" for decimal commas, or "
                            "\"separator\": \",\" for two columns");
      case Commas::mixed:
        throw UnclearLayout(line,
                            "commas are decimal marks and separate columns, too: the numbers "
                            "cannot be told apart for certain. Export the file with semicolons or "
                            "tabs between columns, or state \"separator\": \",\" if all commas "
                            "separate whole numbers");
    }
  }

  void find_kinds() {
    std::vector<std::array<std::size_t, 3>> counts(out_.columns);
    for (const Split& row : rows_)
      for (std::size_t c = 0; c < std::min(out_.columns, row.cells.size()); ++c)
        if (!is_missing_value(row.cells[c]))
          ++counts[c][static_cast<std::size_t>(kind_of(row.cells[c], reading_))];
    // Without rows of pure numbers, lines that hold some texts decide, too.
    for (const auto& count : counts) {
      CellKind kind = CellKind::number;
      if (count[1] > count[0]) kind = CellKind::stamp;
      if (count[2] > count[0] + count[1]) kind = CellKind::text;
      out_.kinds.push_back(kind);
    }
    if (rows_.empty() || header_first_) return;
    // A column without any value, of remarks, may hold texts in a few rows.
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
        // The line after the first.
        out_.names = i;
        out_.first = i + 1;
        return;
      }
      const Split s = split_line(head_[i]);
      if (rows_.empty() || !fits(s)) continue;
      out_.first = i;
      break;
    }
    // A row above it in which something is no number is none of names.
    while (out_.first > 0 && out_.first < head_.size()) {
      const TextLine& above = head_[out_.first - 1];
      if (above.is_comment) break;
      const Split s = split_line(above);
      if (!has_length(s) || !is_data(s)) break;
      --out_.first;
    }
  }

  /// Cells of a line as names of the columns; empty where it has not as many.
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
      // The rows begin below it, whatever it holds itself.
      for (std::size_t i = 0; i < head_.size(); ++i)
        if (head_[i].number == *stated_.header) {
          out_.names = i;
          out_.first = std::max(out_.first, i + 1);
        }
      if (!out_.names)
        throw UnclearLayout(*stated_.header,
                            "\"header\": " + std::to_string(*stated_.header) +
                                " names a line that is empty or not above the rows");
    }
    if (stated_.units_row && *stated_.units_row > 0) {
      out_.units = by_number(*stated_.units_row);
      if (!out_.units)
        throw UnclearLayout(*stated_.units_row,
                            "\"units_row\": " + std::to_string(*stated_.units_row) +
                                " names a line that is empty or not above the rows");
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

  /// Names and units among the lines right above the rows.
  void find_block() {
    std::vector<std::size_t> block;  // upwards
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
    std::optional<std::size_t> units;  // within the block
    if (!out_.units && stated_.units_row.value_or(-1) != 0)
      for (std::size_t b = 0; b < block.size() && !units; ++b)
        if (is_units_line(cells[b])) units = b;
    // Or right above the only one of names.
    if (units == 1U && block.size() == 2 && can_name(cells[0])) {
      out_.units = block[1];
      out_.names = block[0];
      return;
    }
    // A line of units stands below one of names: alone, or below values, it holds the names.
    if (units && (*units + 1 == block.size() || !can_name(cells[*units + 1]))) units.reset();
    if (units) out_.units = block[*units];
    std::size_t names = units ? *units + 1 : 0;
    // Lines of which most cells are empty name nothing where a fuller one is above them.
    while (!units && names + 1 < block.size() && filled(cells[names]) < out_.columns &&
           filled(cells[names + 1]) > filled(cells[names]))
      ++names;
    out_.names = block[names];
  }

  /// Numbers name nothing, but for those of channels: "x-axis,1,2".
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

  /// A line above the rows that looks like names and has another number of them.
  void wrong_header() {
    if (out_.first == 0) return;
    std::size_t above = out_.first - 1;
    while (above > 0 && head_[above].is_comment) --above;
    if (head_[above].is_comment || head_[above].number + 1 != head_[out_.first].number) return;
    const std::vector<std::string> cells = joined(loose_cells(head_[above].text, out_.separator));
    // "Time a b" over "2021-03-01 10:00:00 1 2": one name for a date and a time.
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
    // R leaves out the name of its column of row names.
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
      // One column: a remark is no name.
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

bool is_comment_line(std::string_view line) {
  line = trimmed(line);
  if (line.empty()) return false;
  if (line.starts_with("//") || line.starts_with("***")) return true;
  if (std::string_view("#%!$&>~@").find(line.front()) == std::string_view::npos) return false;
  const std::string_view first = trimmed(line.substr(0, line.find_first_of(",;\t|")));
  const bool error = first.starts_with('#') && first.find('!') != std::string_view::npos;
  return !(is_missing_value(first) && (error || first == "#N/A" || first == "#NV"));
}

std::string_view without_comment_mark(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return text;
  const std::size_t end = text.find_first_not_of("#%!$&>~@*/;: \t");
  if (end != 0) {
    text.remove_prefix(std::min(end, text.size()));
  } else if (text.starts_with("--")) {
    text.remove_prefix(std::min(text.find_first_not_of("- \t"), text.size()));
  } else if ((text.front() == '"' || text.front() == '\'') &&
             std::ranges::count(text, text.front()) % 2 == 1) {
    text = trimmed(text.substr(1));
  }
  return text;
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

bool take_cell(std::string_view& line, char separator, std::string_view& cell) {
  std::size_t at = 0;
  const std::size_t first = line.find_first_not_of(" \t");
  if (first != std::string_view::npos && line[first] == '"') {
    // To the closing quote; "" is a quote within.
    for (at = first + 1; at < line.size(); ++at) {
      if (line[at] != '"') continue;
      if (at + 1 == line.size() || line[at + 1] != '"') break;
      ++at;
    }
  }
  const std::size_t end = separator == ' ' ? line.find_first_of(" \t", std::min(at, line.size()))
                                           : line.find(separator, std::min(at, line.size()));
  cell = line.substr(0, end);
  if (end == std::string_view::npos) return false;
  line.remove_prefix(end + 1);
  if (separator == ' ') line = line.substr(std::min(line.find_first_not_of(" \t"), line.size()));
  return true;
}

std::vector<std::string> loose_cells(std::string_view line, char separator) {
  std::vector<std::string> out;
  if (separator == ' ') line = trimmed(line);
  std::string_view cell;
  for (bool more = true; more;) {
    more = take_cell(line, separator, cell);
    cell = trimmed(cell);
    if (cell.size() > 1 && cell.front() == cell.back() &&
        (cell.front() == '"' || cell.front() == '\''))
      cell = trimmed(cell.substr(1, cell.size() - 2));
    out.push_back(in_utf8(cell));
  }
  return out;
}

std::vector<std::string> names_in(std::string_view line, char separator, std::size_t columns) {
  const auto fits = [&](std::vector<std::string>& names) {
    if (names.size() == columns + 1 && names.back().empty()) names.pop_back();
    // "Headers, time, Ax": what the line holds, in front of it.
    if (names.size() == columns + 1) {
      const std::string low = lower(names.front());
      if (low == "headers" || low == "header" || low == "columns" || low == "names")
        names.erase(names.begin());
    }
    return names.size() == columns && filled(names) > 0;
  };
  std::vector<std::string> names = loose_cells(line, separator);
  if (separator == ' ') {
    if (fits(names)) return names;
    names = joined_names(names);
  }
  if (fits(names)) return names;
  names = wide_cells(line);
  if (columns > 1 && fits(names)) return names;
  // Names may be separated in another way than the rows are.
  for (const char other : {',', ';', '\t'}) {
    if (other == separator || columns < 2) continue;
    names = loose_cells(line, other);
    if (fits(names)) return names;
  }
  return {};
}

TableShape find_shape(const std::vector<TextLine>& head, const std::vector<TextLine>& body,
                      const TextLayout& stated, bool header_first) {
  return Finder(head, body, stated, header_first).find();
}

bool spells_unit(std::string_view text) {
  text = trimmed(text);
  for (const std::string_view brackets : {"[]", "()", "<>", "{}"})
    if (text.size() > 2 && text.front() == brackets[0] && text.back() == brackets[1])
      text = trimmed(text.substr(1, text.size() - 2));
  static constexpr std::string_view kKnown[] = {
      "s",     "ms",   "us",   "µs",     "μs",    "ns",   "sec",   "seconds", "second",   "min",
      "h",     "hr",   "d",    "days",   "hz",    "khz",  "1/s",   "rpm",     "g",        "mg",
      "ug",    "µg",   "n",    "kn",     "mn",    "lbf",  "lb",    "kip",     "kips",     "kgf",
      "m",     "mm",   "cm",   "um",     "µm",    "μm",   "nm",    "km",      "in",       "inch",
      "ft",    "v",    "mv",   "uv",     "µv",    "a",    "ma",    "w",       "kw",       "pa",
      "kpa",   "mpa",  "gpa",  "bar",    "mbar",  "psi",  "ksi",   "°c",      "c",        "degc",
      "deg c", "°f",   "degf", "k",      "°",     "deg",  "rad",   "mrad",    "%",        "gal",
      "kg",    "t",    "µm/m", "um/m",   "μm/m",  "µe",   "ue",    "ustrain", "µstrain",  "strain",
      "mv/v",  "none", "cnt",  "counts", "count", "volt", "volts", "ohm",     "db",       "mm/m",
      "nm/m",  "n·m",  "n*m",  "n-m",    "knm",   "kn·m", "kn*m",  "milli-g", "milli-gs", "gs",
      "g's"};
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (std::ranges::find(kKnown, low) != std::end(kKnown)) return true;
  // Powers and quotients: "m/s²", "m/s^2", "m/s**2", "m s^-2", "mm/sec", "deg/s", "in/s2".
  const std::size_t slash = low.find('/');
  if (slash != std::string::npos) {
    const std::string above = low.substr(0, slash), below = low.substr(slash + 1);
    static constexpr std::string_view kBelow[] = {"s",   "s2",   "s^2",     "s²",   "s**2",
                                                  "sec", "sec2", "sec^2",   "sec²", "h",
                                                  "min", "s/s",  "sec/sec", "hz"};
    const bool known_above = std::ranges::find(kKnown, above) != std::end(kKnown);
    if (known_above && std::ranges::find(kBelow, below) != std::end(kBelow)) return true;
  }
  for (const std::string_view power : {"m s^-2", "ms^-2", "m·s^-2", "m s-2", "ms-2", "m s⁻²",
                                       "m·s⁻²", "ms⁻²", "m/s/s", "m.s-2", "mm s^-1", "m s^-1"})
    if (low == power) return true;
  return false;
}

}  // namespace wheeltap::io
