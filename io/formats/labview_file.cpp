#include "io/formats/labview_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "io/text/text.hpp"
#include "io/text/text_lines.hpp"
#include "io/text/text_number.hpp"
#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

using Fields = std::vector<std::string_view>;

constexpr std::string_view kMagic = "LabVIEW Measurement";
constexpr std::string_view kEnd = "***End_of_Header***";

Fields split(std::string_view line, char separator) {
  Fields out;
  while (true) {
    const std::size_t end = line.find(separator);
    out.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return out;
    line.remove_prefix(end + 1);
  }
}

struct Header {
  char separator = '\t', decimal = '.';
  std::string x_columns = "One";
};

struct Segment {
  std::size_t channels = 0;
  std::vector<double> first, step;  ///< X0 and Delta_X
  double samples = 0.0;             ///< as stated; with a single header, the file may have more
  std::vector<std::string> names, units;
  bool comment = false;
  bool spaced =
      false;  ///< true: keys have a field per column (empty for X columns); false: per channel
};

class Parser {
 public:
  Parser(std::string bytes, const std::filesystem::path& name, const Wanted& wanted)
      : bytes_(std::move(bytes)), lines_(bytes_), name_(name), wanted_(wanted) {}

  Columns parse() {
    read_header();
    Columns out{.file = name_.string()};
    bool first = true;
    while (find_segment()) {
      const Segment segment = read_segment_header();
      if (first) {
        begin(out, segment);
      } else if (segment.channels + 1 != out.columns.size()) {
        corrupt("a segment has " + std::to_string(segment.channels) + " channels, the first has " +
                std::to_string(out.columns.size() - 1));
      }
      if (first) out.first_line = lines_.number + 1;
      first = false;
      read_rows(out, segment);
    }
    if (first) throw FileError(FileError::Kind::corrupt, name_, "holds no segment of samples");
    // Columns that are not requested were read only to check them.
    for (std::size_t c = 0; c < out.columns.size(); ++c)
      if (wanted_ && !wanted_(out, c)) out.columns[c].values.clear();
    return out;
  }

 private:
  [[noreturn]] void corrupt(const std::string& why) const {
    throw FileError(FileError::Kind::corrupt, name_, Place{.line = lines_.number}, why);
  }

  void read_header() {
    if (!lines_.next() || !lines_.line.starts_with(kMagic))
      throw FileError(FileError::Kind::foreign, name_,
                      "does not begin with \"" + std::string(kMagic) + "\"");
    while (lines_.next()) {
      if (trimmed(lines_.line).starts_with(kEnd)) return;
      // The header states the separator of keys and values.
      for (const char by : {'\t', ','}) {
        const Fields f = split(lines_.line, by);
        if (f.size() < 2) continue;
        const std::string_view value = trimmed(f[1]);
        if (f[0] == "Separator") header_.separator = value == "Comma" ? ',' : '\t';
        if (f[0] == "Decimal_Separator")
          header_.decimal = lines_.line.ends_with(',') || value == "," ? ',' : '.';
        if (f[0] == "X_Columns") header_.x_columns = value;
        break;
      }
    }
    corrupt("ends within its header");
  }

  /// Advances to the first line of the next segment's header.
  bool find_segment() {
    if (pending_) {
      pending_ = false;
      return true;
    }
    while (lines_.next())
      if (!trimmed(lines_.line).empty()) return true;
    return false;
  }

  Segment read_segment_header() {
    Segment out;
    do {
      const Fields f = split(lines_.line, header_.separator);
      if (trimmed(f[0]) == kEnd) break;
      const auto numbers = [&] {
        std::vector<double> list;
        for (std::size_t i = 1; i < f.size(); ++i)
          if (!trimmed(f[i]).empty()) list.push_back(number(f[i]));
        return list;
      };
      if (f[0] == "Channels" && f.size() > 1) {
        const double count = number(f[1]);
        if (!(count >= 1.0 && count <= 10000.0) || count != std::floor(count))
          corrupt("Channels \"" + printable(f[1]) + "\": must be a whole number from 1 to 10000");
        out.channels = static_cast<std::size_t>(count);
      }
      if ((f[0] == "Samples" || f[0] == "Delta_X") && f.size() > 3)
        out.spaced = trimmed(f[2]).empty() && !trimmed(f[3]).empty();
      if (f[0] == "Samples")
        for (const double n : numbers()) {
          if (!(n >= 0.0 && n <= 1e15))
            corrupt("Samples " + std::to_string(n) + ": must be a whole number");
          out.samples = std::max(out.samples, n);
        }
      if (f[0] == "X0") out.first = numbers();
      if (f[0] == "Delta_X") out.step = numbers();
      if (f[0] == "Y_Unit_Label")
        for (std::size_t i = 1; i < f.size(); ++i) out.units.emplace_back(in_utf8(trimmed(f[i])));
    } while (lines_.next());
    if (out.channels == 0) corrupt("the header of a segment does not state Channels");
    if (!lines_.next()) corrupt("ends before the names of its columns");
    // X_Value, one name per channel, Comment. For "Multi", X_Value precedes each name.
    Fields names = split(lines_.line, header_.separator);
    while (!names.empty() && trimmed(names.back()).empty()) names.pop_back();
    if (!names.empty() && trimmed(names.back()) == "Comment") {
      out.comment = true;
      names.pop_back();
    }
    const std::size_t per = header_.x_columns == "Multi" ? 2 : 1;
    const std::size_t skip = header_.x_columns == "One" || header_.x_columns == "No" ? 1 : 0;
    for (std::size_t c = 0; c < out.channels; ++c) {
      const std::size_t place = per == 2 ? 2 * c + 1 : skip + c;
      std::string name = place < names.size() ? in_utf8(trimmed(names[place])) : "";
      out.names.push_back(name.empty() ? "channel " + std::to_string(c + 1) : name);
    }
    // With several X columns, a key has one field per column; the fields of X columns are empty.
    // The keys for samples and steps show this layout even if the last channels have no unit.
    bool apart = out.spaced && per == 2;
    if (!apart) apart = per == 2 && out.units.size() + 1 >= 2 * out.channels;
    if (apart) out.units.resize(std::max(out.units.size(), 2 * out.channels));
    for (std::size_t c = 1; c < out.channels && apart && !out.spaced; ++c)
      apart = out.units[2 * c - 1].empty();
    for (std::size_t c = 1; c < out.channels && apart; ++c)
      out.units[c] = std::move(out.units[2 * c]);
    out.units.resize(out.channels);
    return out;
  }

  void begin(Columns& out, const Segment& segment) const {
    out.columns.push_back({.header = "time [s]", .name = "time", .unit = "s"});
    std::map<std::string, int> seen;
    for (std::size_t c = 0; c < segment.channels; ++c) {
      std::string name = segment.names[c];
      if (const int again = seen[name]++; again > 0) name += " " + std::to_string(again + 1);
      const std::string& unit = segment.units[c];
      out.columns.push_back(
          {.header = unit.empty() ? name : name + " [" + unit + "]", .name = name, .unit = unit});
    }
  }

  double number(std::string_view field) const {
    std::string text(trimmed(field));
    if (header_.decimal == ',')
      for (char& c : text)
        if (c == ',') c = '.';
    double value = 0.0;
    const char* end = text.data() + text.size();
    const char* begin = text.starts_with('+') ? text.data() + 1 : text.data();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stop != end)
      corrupt("\"" + printable(field) + "\" is not a number");
    return value;
  }

  /// Counts the printed digits, because times often have fewer digits than their resolution needs.
  void count_digits(std::string_view field, Column& column) const {
    field = trimmed(field);
    PrintedDigits digits{column.decimals, column.digits};
    double ignored = 0.0;
    static_cast<void>(
        read_number(field.data(), field.data() + field.size(), ignored, digits, header_.decimal));
    column.decimals = digits.decimals;
    column.digits = digits.digits;
  }

  void read_rows(Columns& out, const Segment& segment) {
    const bool multi = header_.x_columns == "Multi", none = header_.x_columns == "No";
    const std::size_t width = multi ? 2 * segment.channels : segment.channels + 1;
    long row = 0;
    const double from = segment.first.empty() ? 0.0 : segment.first[0];
    const double step = segment.step.empty() ? 1.0 : segment.step[0];
    while (lines_.next()) {
      if (trimmed(lines_.line).empty()) continue;
      if (lines_.line.starts_with("Channels")) {
        pending_ = true;
        break;
      }
      const Fields f = split(lines_.line, header_.separator);
      if (f.size() < width)
        corrupt("a row of " + std::to_string(f.size()) + " fields: must have " +
                std::to_string(width));
      const bool has_x = !none && !trimmed(f[0]).empty();
      const double x = has_x ? number(f[0]) : from + step * static_cast<double>(row);
      out.columns[0].values.push_back(x);
      if (has_x) count_digits(f[0], out.columns[0]);
      for (std::size_t c = 0; c < segment.channels; ++c) {
        if (multi && number(f[2 * c]) != x)
          corrupt("channels " + std::to_string(1) + " and " + std::to_string(c + 1) +
                  " have different times: a table needs one time column");
        const std::string_view field = f[multi ? 2 * c + 1 : c + 1];
        out.columns[c + 1].values.push_back(
            trimmed(field).empty() ? std::numeric_limits<double>::quiet_NaN() : number(field));
      }
      ++row;
    }
    if (static_cast<double>(row) < segment.samples)
      corrupt("only " + std::to_string(row) + " of " +
              std::to_string(std::llround(segment.samples)) +
              " samples are there: it is truncated");
  }

  std::string bytes_;
  Lines lines_;
  std::filesystem::path name_;
  const Wanted& wanted_;
  Header header_;
  bool pending_ = false;
};

}  // namespace

Columns parse_labview(std::string bytes, const std::filesystem::path& name, const Wanted& wanted) {
  return Parser(std::move(bytes), name, wanted).parse();
}

}  // namespace wheeltap::io
