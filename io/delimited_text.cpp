#include "io/delimited_text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>

#include "io/text.hpp"

namespace wheeltap::io {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Reads the decimal number at the start of [p, end) and how finely it is printed. Returns one past
/// it; null where there is none, or it is not a plain one (nan, inf, beyond the range).
///
/// Digits without point and powers of ten up to 10²² are doubles where the former stay below 2⁵³:
/// their product or quotient is then rounded once, to the nearest double (Clinger 1990, "How to
/// read floating point numbers accurately", section 3). All others go to std::from_chars.
const char* read_number(const char* p, const char* end, double& value, Column& column) {
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  const char* const start = p;
  std::uint64_t mantissa = 0;
  int significant = 0, after_point = 0, digits = 0;
  bool point = false;
  for (; p < end; ++p) {
    if (is_digit(*p)) {
      ++digits;
      if (significant > 0 || *p != '0') {
        // Nineteen digits fit; more are left to from_chars.
        if (++significant <= 19) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p - '0');
      }
      if (point) ++after_point;
    } else if (*p == '.' && !point) {
      point = true;
    } else {
      break;
    }
  }
  if (digits == 0) return nullptr;
  int exponent = 0;
  if (p < end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    const bool down = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+')) ++q;
    if (q == end || !is_digit(*q)) return nullptr;
    for (; q < end && is_digit(*q); ++q) exponent = std::min(10 * exponent + (*q - '0'), 100'000);
    if (down) exponent = -exponent;
    p = q;
  }
  const int power = exponent - after_point;
  if (significant <= 19 && mantissa <= (std::uint64_t{1} << 53) && power >= -22 && power <= 22) {
    const auto whole = static_cast<double>(mantissa);
    value = power < 0 ? whole / kPowers[-power] : whole * kPowers[power];
  } else {
    const auto [last, error] = std::from_chars(start, p, value);
    if (error != std::errc() || last != p) return nullptr;
  }
  if (negative) value = -value;
  column.decimals = std::max(column.decimals, -power);
  column.digits = std::max(column.digits, significant);
  return p;
}

/// Takes the next cell off the front of a line, with the separator behind it; blanks and quotes
/// are still on it. Returns whether there is another.
bool take(std::string_view& line, char separator, std::string_view& cell) {
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

std::string shown(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return "'" + std::string(text.substr(0, kShown)) + "'";
}

/// Whether a bracket of a header is still to be closed.
bool is_open(std::string_view header) {
  return std::ranges::count(header, '[') > std::ranges::count(header, ']') ||
         std::ranges::count(header, '(') > std::ranges::count(header, ')');
}

/// "1,5" → "1.5": how a number with a decimal comma must be written.
std::string with_point(std::string_view text) {
  std::string out(text);
  if (std::count(out.begin(), out.end(), ',') != 1) return {};
  std::replace(out.begin(), out.end(), ',', '.');
  return parse_number(out) ? out : std::string();
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void DelimitedText::fail(Place place, const std::string& reason) const {
  throw FileError(FileError::Kind::corrupt, name_, std::move(place), reason);
}

std::string_view DelimitedText::line_at(std::size_t start) const {
  const std::string_view rest = std::string_view(text_).substr(start);
  std::string_view line = rest.substr(0, rest.find(newline_));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string DelimitedText::content(std::string_view raw, const Place& place) const {
  raw = trimmed(raw);
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
  if (separator_ == ' ') line = trimmed(line);
  std::string_view raw;
  for (bool more = true; more;) {
    more = take(line, separator_, raw);
    out.push_back(
        content(raw, {.line = number, .column = static_cast<std::ptrdiff_t>(out.size()) + 1}));
  }
  return out;
}

void DelimitedText::choose_separator(std::string_view first, std::string_view second,
                                     FirstRow first_row) {
  std::size_t most = 0;
  for (const char candidate : {',', ';', '\t'}) {
    std::string_view line = first, cell;
    std::size_t count = 0;
    while (take(line, candidate, cell)) ++count;
    if (count > most) most = count, separator_ = candidate;
  }
  if (most > 0 && separator_ != '\t') return;
  // Blanks separate numbers only: "velocity [m/s]" alone is one column. A tab is one of them where
  // there are more numbers than it separates.
  const auto numbers = [](std::string_view line) -> std::size_t {
    line = trimmed(line);
    std::string_view cell;
    std::size_t count = 0;
    for (bool more = true; more; ++count) {
      more = take(line, ' ', cell);
      if (!parse_number(cell)) return 0;
    }
    return count;
  };
  const bool header = first_row == FirstRow::header || numbers(first) == 0;
  if (numbers(header ? second : first) > most + 1) separator_ = ' ';
}

DelimitedText::DelimitedText(std::string bytes, std::filesystem::path name, FirstRow first_row)
    : text_(std::move(bytes)), name_(std::move(name)) {
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF"))
    fail({}, "is UTF-16 text; save it as UTF-8");
  if (const std::size_t nul = text_.find('\0'); nul != std::string::npos)
    fail({.line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(nul),
                                 '\n')},
         "is not text: there is a NUL byte");
  if (text_.find('\n') == std::string::npos && text_.find('\r') != std::string::npos)
    newline_ = '\r';

  int number = 0, empty = 0;
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
    if (first == end || text_[first] == '#') {
      if (first_line_ > 0) skipped_.push_back(rows());
      if (first == end && !starts_.empty() && empty == 0) empty = number;
      continue;
    }
    if (first_line_ == 0) first_line_ = number;
    if (empty > 0 && empty_line_ == 0) empty_line_ = empty;
    starts_.push_back(start);
  }
  if (starts_.empty()) return;

  const std::string_view first = line_at(starts_[0]);
  choose_separator(first, starts_.size() > 1 ? line_at(starts_[1]) : std::string_view(), first_row);
  std::vector<std::string> cells = split(first, first_line_);
  if (first_row == FirstRow::detected && std::ranges::all_of(cells, [](const std::string& cell) {
        return cell.empty() || parse_number(cell).has_value();
      })) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      headers_.push_back(column_of_header(std::to_string(i + 1)));
    return;
  }
  for (const std::string& cell : cells) {
    // A unit stands after a blank that separates: "time [s] force [N]".
    const bool joins =
        separator_ == ' ' && !headers_.empty() &&
        (cell.starts_with('[') || cell.starts_with('(') || is_open(headers_.back().header));
    if (joins)
      headers_.back() = column_of_header(headers_.back().header + " " + cell);
    else
      headers_.push_back(column_of_header(cell));
  }
  // From here on rows are those below the header.
  header_line_ = first_line_;
  starts_.erase(starts_.begin());
  first_line_ = header_line_ + 1;
  for (int& row : skipped_) --row;
}

int DelimitedText::line(int row) const {
  const auto before = std::upper_bound(skipped_.begin(), skipped_.end(), row);
  return first_line_ + row + static_cast<int>(before - skipped_.begin());
}

std::vector<std::string> DelimitedText::cells(int row) const {
  return split(line_at(starts_.at(static_cast<std::size_t>(row))), line(row));
}

Columns DelimitedText::columns(const Wanted& wanted) const {
  Columns table{
      .file = name_.string(), .columns = headers_, .first_line = first_line_, .skipped = skipped_};
  if (empty_line_ > 0) fail({.line = empty_line_}, "empty line");
  if (starts_.empty()) fail({}, "no data");
  std::vector<char> reads(headers_.size(), 1);
  for (std::size_t c = 0; wanted && c < reads.size(); ++c) reads[c] = wanted(table, c) ? 1 : 0;
  for (std::size_t c = 0; c < reads.size(); ++c)
    if (reads[c] != 0) table.columns[c].values.resize(starts_.size());

  const auto is_gap = [this](char c) { return c == ' ' || (c == '\t' && separator_ != '\t'); };
  for (std::size_t row = 0; row < starts_.size(); ++row) {
    std::string_view line = line_at(starts_[row]);
    if (separator_ == ' ') line = trimmed(line);
    std::size_t c = 0;
    std::string_view cell;
    for (bool more = true; more; ++c) {
      const bool read = c < reads.size() && reads[c] != 0;
      double value = std::numeric_limits<double>::quiet_NaN();
      if (read) {
        // A plain number and what follows it, without looking for the end of the cell first.
        const char* p = line.data();
        const char* const end = p + line.size();
        while (p < end && is_gap(*p)) ++p;
        const char* q = read_number(p, end, value, table.columns[c]);
        if (q != nullptr) {
          const char* const past = q;
          while (q < end && is_gap(*q)) ++q;
          if (q == end || (separator_ == ' ' ? q > past : *q == separator_)) {
            table.columns[c].values[row] = value;
            more = q < end;
            if (more)
              line.remove_prefix(static_cast<std::size_t>(q - line.data()) +
                                 (separator_ == ' ' ? 0 : 1));
            continue;
          }
        }
      }
      more = take(line, separator_, cell);
      if (!read) continue;
      const std::string text = content(cell, table.place(row, static_cast<int>(c)));
      const std::optional<double> number =
          text.empty() ? std::numeric_limits<double>::quiet_NaN() : parse_number(text);
      if (!number) {
        const std::string meant = with_point(text);
        fail(table.place(row, static_cast<int>(c)),
             shown(text) + " is not a number" +
                 (meant.empty() ? "" : " (with a decimal point: " + meant + ")"));
      }
      table.columns[c].values[row] = *number;
      double ignored = 0.0;
      static_cast<void>(
          read_number(text.data(), text.data() + text.size(), ignored, table.columns[c]));
      table.columns[c].decimals = std::max(table.columns[c].decimals, 0);
      table.columns[c].digits = std::max(table.columns[c].digits, 0);
    }
    if (c != headers_.size())
      fail(table.place(row), std::to_string(c) + " columns, must be " +
                                 std::to_string(headers_.size()) + " as in the first line");
  }
  return table;
}

Columns parse_delimited_text(std::string bytes, const std::filesystem::path& name,
                             const Wanted& wanted) {
  return DelimitedText(std::move(bytes), name).columns(wanted);
}

}  // namespace wheeltap::io
