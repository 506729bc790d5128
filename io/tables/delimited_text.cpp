#include "io/tables/delimited_text.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>

#include "io/tables/stamp_column.hpp"
#include "io/text/text.hpp"
#include "io/text/text_cells.hpp"
#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

constexpr int kHeadRows = 1000;  // rows searched for the first row of numbers
constexpr std::size_t kHeadComments = 5000;
constexpr int kBodyRows = 100;  // rows from the middle of a long text

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

std::string shown(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return "'" + printable(in_utf8(text.substr(0, kShown))) + "'";
}

bool has_decimal_comma(std::string_view text) {
  return std::count(text.begin(), text.end(), ',') == 1 && parse_number(text, ',');
}

/// Converts UTF-16 with a byte order mark, or with a zero in every other byte, to UTF-8. Unpaired
/// surrogates become U+FFFD.
std::string without_utf16(std::string text) {
  const bool little = text.starts_with("\xFF\xFE"), big = text.starts_with("\xFE\xFF");
  bool swapped = big;
  std::size_t at = 2;
  if (!little && !big) {
    if (text.size() < 8) return text;
    const std::size_t looked = std::min<std::size_t>(text.size() / 2 * 2, 64);
    bool low = true, high = true;
    for (std::size_t i = 0; i < looked; i += 2) {
      low = low && text[i + 1] == '\0' && text[i] != '\0';
      high = high && text[i] == '\0' && text[i + 1] != '\0';
    }
    if (!low && !high) return text;
    swapped = high;
    at = 0;
  }
  const auto unit = [&](std::size_t i) -> char32_t {
    const auto a = static_cast<unsigned char>(text[i]), b = static_cast<unsigned char>(text[i + 1]);
    return swapped ? static_cast<char32_t>(a << 8U | b) : static_cast<char32_t>(b << 8U | a);
  };
  std::string out;
  out.reserve(text.size() / 2);
  for (; at + 1 < text.size(); at += 2) {
    char32_t code = unit(at);
    if (code >= 0xD800 && code < 0xE000) {
      const char32_t next = at + 3 < text.size() ? unit(at + 2) : 0;
      if (code < 0xDC00 && next >= 0xDC00 && next < 0xE000) {
        code = 0x10000 + ((code - 0xD800) << 10U) + (next - 0xDC00);
        at += 2;
      } else {
        code = 0xFFFD;
      }
    }
    const auto put = [&](char32_t byte) { out += static_cast<char>(byte); };
    if (code < 0x80) {
      put(code);
    } else if (code < 0x800) {
      put(0xC0U | (code >> 6U)), put(0x80U | (code & 0x3FU));
    } else if (code < 0x10000) {
      put(0xE0U | (code >> 12U)), put(0x80U | ((code >> 6U) & 0x3FU)), put(0x80U | (code & 0x3FU));
    } else {
      put(0xF0U | (code >> 18U)), put(0x80U | ((code >> 12U) & 0x3FU));
      put(0x80U | ((code >> 6U) & 0x3FU)), put(0x80U | (code & 0x3FU));
    }
  }
  return out;
}

/// True if the name of a column says that it contains times.
bool named_as_time(std::string_view name) {
  const std::string word = lower(name);
  return word.starts_with("time") || word.starts_with("date") || word.ends_with("time");
}

/// Returns the separator that a line "sep=;" states for spreadsheets.
std::optional<char> stated_separator(std::string_view line) {
  line = trimmed(line);
  if (line.size() > 2 && line.front() == '"' && line.back() == '"')
    line = line.substr(1, line.size() - 2);
  if (line.size() < 5 || (line[0] != 's' && line[0] != 'S') || line.substr(1, 3) != "ep=")
    return std::nullopt;
  return parse_separator(line.substr(4));
}

}  // namespace

void DelimitedText::fail(Place place, const std::string& reason) const {
  throw FileError(FileError::Kind::corrupt, name_, std::move(place), reason);
}

std::string_view DelimitedText::line_at(std::size_t start) const {
  const std::string_view rest = std::string_view(text_).substr(start);
  std::string_view line = rest.substr(0, rest.find(newline_));
  while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string DelimitedText::content(std::string_view raw, const Place& place) const {
  raw = trimmed(raw);
  if (raw.size() > 1 && raw.front() == '\'' && raw.back() == '\'')
    return in_utf8(trimmed(raw.substr(1, raw.size() - 2)));
  if (!raw.starts_with('"')) return in_utf8(raw);
  std::string cell;
  std::size_t at = 1;
  for (; at < raw.size(); ++at) {
    if (raw[at] == '"') {
      if (at + 1 == raw.size() || raw[at + 1] != '"') break;
      ++at;
    }
    cell += raw[at];
  }
  if (at == raw.size()) fail(place, shown(raw) + " has a quote that is not closed on its line");
  if (at + 1 != raw.size()) fail(place, shown(raw) + " has text after its closing quote");
  return in_utf8(trimmed(cell));
}

std::vector<std::string> DelimitedText::split(std::string_view line, int number) const {
  std::vector<std::string> out;
  if (shape_.separator == ' ') line = trimmed(line);
  std::string_view raw;
  for (bool more = true; more;) {
    more = take_cell(line, shape_.separator, raw);
    out.push_back(
        content(raw, {.line = number, .column = static_cast<std::ptrdiff_t>(out.size()) + 1}));
  }
  for (std::size_t n = 0; n < shape_.trailing && out.size() > shape_.columns && out.back().empty();
       ++n)
    out.pop_back();
  return out;
}

DelimitedText::DelimitedText(std::string bytes, std::filesystem::path name, FirstRow first_row,
                             TextLayout stated)
    : text_(without_utf16(std::move(bytes))), name_(std::move(name)), stated_(std::move(stated)) {
  // Removes the end-of-text mark of old DOS programs.
  while (text_.ends_with('\x1a')) text_.pop_back();
  if (const std::size_t nul = text_.find('\0'); nul != std::string::npos)
    fail({.line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(nul),
                                 '\n')},
         "is not text: there is a NUL byte");
  if (!stated_.time_format.empty() && !parse_time_format(stated_.time_format))
    fail({},
         "\"time_format\": \"" + printable(stated_.time_format) +
             "\" is not a format of time stamps: give \"day-first\", \"month-first\" or a pattern "
             "like \"%d.%m.%Y %H:%M:%S\"");
  scan();
  if (!starts_.empty()) find_layout(first_row);
  layout_.first_row = first_line_;
}

/// Finds the rows, comments and empty lines.
void DelimitedText::scan() {
  if (text_.find('\n') == std::string::npos && text_.find('\r') != std::string::npos)
    newline_ = '\r';
  int number = 0;
  for (std::size_t at = text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
       at < text_.size();) {
    const std::size_t start = at;
    const void* const found = std::memchr(text_.data() + at, newline_, text_.size() - at);
    const std::size_t end =
        found == nullptr ? text_.size()
                         : static_cast<std::size_t>(static_cast<const char*>(found) - text_.data());
    at = end + 1;
    ++number;
    std::size_t first = start;
    while (first < end && is_blank(text_[first])) ++first;
    const bool is_empty = first == end;
    const bool is_comment = !is_empty && (text_[first] < '0' || text_[first] > '9') &&
                            is_comment_line(std::string_view(text_).substr(first, end - first));
    const bool is_skipped = stated_.skip && number <= *stated_.skip;
    // A first line "sep=;" states the separator and is not a row.
    if (number == 1 && !is_empty && !is_comment)
      if (const std::optional<char> separator =
              stated_separator(std::string_view(text_).substr(start, end - start))) {
        if (!stated_.separator) stated_.separator = separator;
        continue;
      }
    if (is_empty || is_comment || is_skipped) {
      if (first_line_ > 0) skipped_.push_back(rows());
      if (is_empty) empty_.emplace_back(rows(), number);
      if (is_comment && !is_skipped && rows() <= kHeadRows && comments_.size() < kHeadComments)
        comments_.emplace_back(start, number);
      continue;
    }
    if (first_line_ == 0) first_line_ = number;
    starts_.push_back(start);
  }
}

void DelimitedText::find_layout(FirstRow first_row) {
  std::vector<TextLine> head, body;
  std::vector<int> row_of;  // row of each line of the head; for comments, the next row
  const int head_rows = std::min(rows(), kHeadRows);
  auto comment = comments_.begin();
  for (int row = 0; row < head_rows; ++row) {
    const int number = line(row);
    for (; comment != comments_.end() && comment->second < number; ++comment) {
      head.push_back({line_at(comment->first), comment->second, true});
      row_of.push_back(row);
    }
    head.push_back({line_at(starts_[static_cast<std::size_t>(row)]), number, false});
    row_of.push_back(row);
  }
  const int from = std::max(head_rows, rows() / 2);
  for (int row = from; row < std::min(rows(), from + kBodyRows); ++row)
    body.push_back({line_at(starts_[static_cast<std::size_t>(row)]), line(row), false});
  try {
    shape_ = find_shape(head, body, stated_, first_row == FirstRow::header);
  } catch (const UnclearLayout& unclear) {
    fail({.line = unclear.line}, unclear.what());
  }
  layout_.columns = static_cast<int>(shape_.columns);
  layout_.used = {.separator = shape_.separator,
                  .decimal = shape_.decimal,
                  .skip = stated_.skip,
                  .header = 0,
                  .units_row = 0,
                  .time_format = {}};
  const TextLine* units = shape_.units ? &head[*shape_.units] : nullptr;
  if (shape_.names) {
    take_names(head[*shape_.names], units);
  } else {
    for (std::size_t c = 0; c < std::max<std::size_t>(shape_.columns, 1); ++c)
      headers_.push_back(column_of_header(std::to_string(c + 1)));
  }
  for (std::size_t c = 0; c < std::min(headers_.size(), shape_.kinds.size()); ++c)
    headers_[c].cells = shape_.kinds[c];
  const int first = shape_.first < head.size() ? row_of[shape_.first] : head_rows;
  if (!stated_.skip) {
    const int top = std::min(shape_.names ? head[*shape_.names].number : line(first), line(first));
    layout_.used.skip = std::max(0, top - 1);
  }
  constexpr std::size_t kAbove = 100;
  for (std::size_t i = 0; i < std::min({shape_.first, head.size(), kAbove}); ++i)
    layout_.above.push_back({head[i].number, in_utf8(trimmed(without_comment_mark(head[i].text)))});
  if (first_row == FirstRow::detected) refuse_wrapped_series();
  drop_rows(first);
  if (first_row == FirstRow::detected) drop_tail();
}

/// Rejects one series that is written with several samples per line, because the columns of this
/// text are not channels.
void DelimitedText::refuse_wrapped_series() const {
  const auto any = [&](auto&& is) { return std::ranges::any_of(layout_.above, is); };
  const auto begins = [&](std::string_view key) {
    return any([&](const HeadLine& line) { return line.text.starts_with(key); });
  };
  const bool slist = any([](const HeadLine& line) {
    return line.text.starts_with("TIMESERIES ") && line.text.find("SLIST") != std::string::npos;
  });
  const bool knet = begins("Scale Factor") && begins("Sampling Freq");
  if (!slist && !knet) return;
  fail({.line = layout_.above.front().number},
       std::string("rows hold several samples of one series (") + (slist ? "SLIST" : "K-NET") +
           "), so columns are not channels: write one sample per line" +
           (slist ? " (TSPAIR)" : ", times its scale factor") + ", or use a MATLAB or NumPy file");
}

/// Excludes remarks after the rows; a truncated row is not a remark.
void DelimitedText::drop_tail() {
  constexpr int kMostRemarks = 50;
  int end = rows();
  while (end > 1 && rows() - end < kMostRemarks &&
         is_remark(line_at(starts_[static_cast<std::size_t>(end) - 1]), shape_))
    --end;
  if (end == rows() || end == rows() - kMostRemarks) return;
  layout_.tail_from = line(end);
  layout_.tail_to = line(rows() - 1);
  starts_.resize(static_cast<std::size_t>(end));
  std::erase_if(skipped_, [&](int row) { return row > end; });
  std::erase_if(empty_, [&](const auto& line) { return line.first >= end; });
}

void DelimitedText::take_names(const TextLine& names, const TextLine* units) {
  header_line_ = names.number;
  layout_.used.header = names.number;
  const std::size_t named = shape_.columns - (shape_.date_unnamed ? 1 : 0);
  const bool empty_first = names.text.starts_with(shape_.separator);
  std::vector<std::string> cells =
      names_in(empty_first && !names.is_comment ? names.text : without_comment_mark(names.text),
               shape_.separator, named);
  if (cells.empty()) cells = names_in(names.text, shape_.separator, named);
  if (shape_.date_unnamed && !cells.empty()) cells.insert(cells.begin(), "date");
  const bool marked = !cells.empty() && trimmed(names.text).starts_with('"') &&
                      std::ranges::count(names.text, '"') % 2 == 1;
  if (!names.is_comment && !marked) {
    // Rejects unclosed quotes, and a number of names that differs from the number of columns.
    std::vector<std::string> strict = split(names.text, names.number);
    if (cells.empty()) {
      if (shape_.index_unnamed) strict.insert(strict.begin(), "row");
      cells = std::move(strict);
    }
  }
  std::vector<std::string> unit_cells;
  if (units != nullptr) {
    layout_.used.units_row = units->number;
    unit_cells = loose_cells(units->text, shape_.separator);
    if (unit_cells.size() < cells.size())
      unit_cells = names_in(without_comment_mark(units->text), shape_.separator, shape_.columns);
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    Column column = column_of_header(cells[c].empty() ? std::to_string(c + 1) : in_utf8(cells[c]));
    if (c < unit_cells.size() && column.unit.empty()) {
      std::string unit = in_utf8(unit_cells[c]);
      for (const std::string_view brackets : {"[]", "()"})
        if (unit.size() > 2 && unit.front() == brackets[0] && unit.back() == brackets[1])
          unit = unit.substr(1, unit.size() - 2);
      if (unit != "TS" && unit != "RN" && unit != "-") column.unit = unit;
      if (!column.unit.empty()) column.header = column.name + " [" + column.unit + "]";
    }
    headers_.push_back(std::move(column));
  }
}

/// Removes the first `count` rows.
void DelimitedText::drop_rows(int count) {
  const int number = line(count);
  starts_.erase(starts_.begin(), starts_.begin() + count);
  std::erase_if(skipped_, [&](int row) { return row <= count; });
  for (int& row : skipped_) row -= count;
  for (auto& line : empty_) line.first -= count;
  first_line_ = number;
}

int DelimitedText::line(int row) const {
  const auto before = std::upper_bound(skipped_.begin(), skipped_.end(), row);
  return first_line_ + row + static_cast<int>(before - skipped_.begin());
}

std::vector<std::string> DelimitedText::cells(int row) const {
  return split(line_at(starts_.at(static_cast<std::size_t>(row))), line(row));
}

std::optional<double> DelimitedText::number(std::string_view cell) const {
  if (is_missing_value(cell)) return std::numeric_limits<double>::quiet_NaN();
  if (const std::optional<double> found = parse_number(cell, shape_.decimal)) return found;
  if (const std::optional<double> found =
          parse_grouped_number(cell, shape_.decimal, shape_.grouped))
    return found;
  if (is_missing_word(cell)) return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

/// Reads a cell that is not a plain number: nan, inf, a missing value, or an error.
double DelimitedText::plain_number(const std::string& text, Place place, Column& column) const {
  const std::optional<double> found = number(text);
  if (!found) {
    std::string reason = shown(text) + " is not a number";
    if (shape_.decimal == '.' && has_decimal_comma(text))
      reason += " (decimal commas are read with \"decimal\": \",\")";
    else if (shape_.decimal == ',' && parse_number(text))
      reason +=
          " with a decimal comma, unlike other cells (if all numbers have decimal points, state "
          "\"decimal\": \".\")";
    else if (column.cells == CellKind::number && read_stamp(text).stamp)
      reason += ", unlike the cells above";
    else if (named_as_time(column.name))
      reason +=
          " or a known time stamp: state the form of the times, for example \"time_format\": "
          "\"%d.%m.%Y %H:%M:%S\"";
    else
      reason +=
          ": leave the cell empty if it stands for a missing value, or do not read this column "
          "(\"role\": \"ignore\")";
    fail(std::move(place), reason);
  }
  PrintedDigits digits{column.decimals, column.digits};
  double ignored = 0.0;
  static_cast<void>(
      read_number(text.data(), text.data() + text.size(), ignored, digits, shape_.decimal));
  column.decimals = std::max(digits.decimals, 0);
  column.digits = std::max(digits.digits, 0);
  return *found;
}

/// Returns the order of day and month in a column of time stamps. The result is unknown if no stamp
/// is ambiguous, or if no stamp shows the order.
DayOrder DelimitedText::day_order(int column) const {
  bool unclear = false;
  for (int row = 0; row < rows(); ++row) {
    const std::vector<std::string> found = cells(row);
    if (static_cast<std::size_t>(column) >= found.size()) continue;
    const std::string& cell = found[static_cast<std::size_t>(column)];
    const StampReading reading = read_stamp(cell);
    if (reading.order != DayOrder::unknown) return reading.order;
    if (reading.stamp && row == 0) return DayOrder::unknown;
    unclear = unclear || reading.ambiguous;
  }
  if (!unclear) return DayOrder::unknown;
  Columns table{.file = name_.string(), .columns = headers_, .first_line = first_line_};
  const std::vector<std::string> found = cells(0);
  fail(table.place(0, column), "the date of " + shown(found[static_cast<std::size_t>(column)]) +
                                   " is ambiguous, with day or month first: state \"time_format\": "
                                   "\"day-first\" or \"time_format\": "
                                   "\"month-first\"");
}

/// Returns the reason why a text has no rows, and a remedy.
std::string DelimitedText::no_data() const {
  if (text_.find_first_not_of(" \t\r\n") == std::string::npos) return "no data";
  std::string out = "no data: no line has numbers or times (without units) separated by ";
  if (stated_.separator) {
    out += std::string(separator_name(*stated_.separator)) + "s";
  } else {
    out += "commas, semicolons, tabs, bars or blanks";
  }
  if (stated_.skip)
    out += " below the " + std::to_string(*stated_.skip) + " lines that are skipped";
  return out + ". Export the table with one of these separators";
}

Columns DelimitedText::columns(const Wanted& wanted) const {
  Columns table{.file = name_.string(),
                .columns = headers_,
                .first_line = first_line_,
                .skipped = skipped_,
                .layout = layout_};
  // Accept an empty line after each row, because some programs write it.
  const auto within = std::ranges::count_if(
      empty_, [&](const auto& line) { return line.first > 0 && line.first < rows(); });
  if (within != rows() - 1 || rows() < 3)
    for (const auto& [row, number] : empty_)
      if (row > 0 && row < rows())
        fail({.line = number},
             "empty line: delete it, or cut the file there if another table follows");
  if (starts_.empty()) fail({}, no_data());
  std::vector<char> reads(headers_.size(), 1);
  for (std::size_t c = 0; wanted && c < reads.size(); ++c) reads[c] = wanted(table, c) ? 1 : 0;
  const TimeFormat format =
      stated_.time_format.empty() ? TimeFormat{} : *parse_time_format(stated_.time_format);
  std::vector<std::optional<StampColumn>> stamps(reads.size());
  for (std::size_t c = 0; c < reads.size(); ++c) {
    if (reads[c] == 0) continue;
    table.columns[c].values.resize(starts_.size());
    if (headers_[c].cells != CellKind::stamp) continue;
    TimeFormat of_column = format;
    if (format.pattern.empty() && format.order == DayOrder::unknown)
      of_column.order = day_order(static_cast<int>(c));
    stamps[c].emplace(of_column, stated_.time_format);
  }

  const char separator = shape_.separator, decimal = shape_.decimal;
  const auto is_gap = [separator](char c) { return c == ' ' || (c == '\t' && separator != '\t'); };
  for (std::size_t row = 0; row < starts_.size(); ++row) {
    std::string_view line = line_at(starts_[row]);
    if (separator == ' ') line = trimmed(line);
    std::size_t c = 0;
    std::string_view cell;
    std::size_t empties = 0;  // empty cells at the end
    for (bool more = true; more; ++c) {
      const bool read = c < reads.size() && reads[c] != 0;
      double value = std::numeric_limits<double>::quiet_NaN();
      if (read && !stamps[c] && separator != decimal) {
        // Reads a plain number and its separator fast, without a search for the end of the
        // cell.
        const char* p = line.data();
        const char* const end = p + line.size();
        while (p < end && is_gap(*p)) ++p;
        Column& column = table.columns[c];
        PrintedDigits digits{column.decimals, column.digits};
        const char* q = read_number(p, end, value, digits, decimal);
        if (q != nullptr) {
          const char* const past = q;
          while (q < end && is_gap(*q)) ++q;
          if (q == end || (separator == ' ' ? q > past : *q == separator)) {
            column.values[row] = value;
            column.decimals = digits.decimals;
            column.digits = digits.digits;
            more = q < end;
            empties = 0;
            if (more)
              line.remove_prefix(static_cast<std::size_t>(q - line.data()) +
                                 (separator == ' ' ? 0 : 1));
            continue;
          }
        }
      }
      more = take_cell(line, separator, cell);
      empties = trimmed(cell).empty() ? empties + 1 : 0;
      if (!read) continue;
      const Place place = table.place(row, static_cast<int>(c));
      const std::string text = content(cell, place);
      if (stamps[c]) {
        double& seconds = table.columns[c].values[row];
        if (is_missing_value(text))
          seconds = value;
        else if (const std::string reason = stamps[c]->read(text, seconds); !reason.empty())
          fail(place, shown(text) + reason);
        continue;
      }
      table.columns[c].values[row] = plain_number(text, place, table.columns[c]);
    }
    if (c > headers_.size() && c - headers_.size() <= std::min(empties, shape_.trailing))
      c = headers_.size();
    if (shape_.optional_last && c + 1 == headers_.size()) {
      if (reads[c] != 0) table.columns[c].values[row] = std::numeric_limits<double>::quiet_NaN();
      ++c;
    }
    if (c != headers_.size()) {
      std::string reason = std::to_string(c) + " columns, must be " +
                           std::to_string(headers_.size()) + " as in line " +
                           std::to_string(header_line_ > 0 ? header_line_ : first_line_);
      // If the names do not match the first row, they may not be a header.
      if (shape_.separator == ',' && c > headers_.size() && row == 0)
        reason +=
            " (if the numbers have decimal commas, export the table with semicolons between the "
            "columns; if that line holds no names, state \"header\": 0)";
      else if (row == 0 && header_line_ > 0)
        reason += " (if that line holds no names, state \"header\": 0, or the line of the names)";
      else if (row + 1 == starts_.size())
        reason += ": the last row is truncated; delete it";
      fail(table.place(row), reason);
    }
  }
  for (std::size_t c = 0; c < reads.size(); ++c) {
    if (!stamps[c] || !stamps[c]->first()) continue;
    Column& column = table.columns[c];
    column.unit = "s";
    column.decimals = stamps[c]->decimals();
    column.digits = 19;  // number of exact digits
    if (!table.layout->start.empty()) continue;
    table.layout->start = text_of(*stamps[c]->first());
    table.layout->start_has_zone = stamps[c]->first()->has_zone;
    table.layout->used.time_format = stamps[c]->pattern();
  }
  return table;
}

Columns parse_delimited_text(std::string bytes, const std::filesystem::path& name,
                             const Wanted& wanted, const TextLayout& stated) {
  return DelimitedText(std::move(bytes), name, FirstRow::detected, stated).columns(wanted);
}

}  // namespace wheeltap::io
