#include "io/formats/strong_motion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file_error.hpp"
#include "io/text/text.hpp"
#include "io/text/text_lines.hpp"
#include "io/text/text_number.hpp"
#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

constexpr double kMostPoints = 1e8;

/// The line with each run of blanks replaced by one blank.
std::string collapsed(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '\t')
      out += c;
    else if (!out.empty() && out.back() != ' ')
      out += ' ';
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

/// The numbers among the words of a line.
std::vector<double> numbers_in(std::string_view line) {
  std::vector<double> out;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t from = line.find_first_of("0123456789.", at);
    if (from == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_not_of("0123456789.eE+-", from), line.size());
    at = end;
    std::string_view word = line.substr(from, end - from);
    while (!word.empty()) {  // removes text like "SEC." after a number
      if (const auto value = parse_number(word)) {
        out.push_back(*value);
        break;
      }
      word.remove_suffix(1);
    }
  }
  return out;
}

/// Returns "Chan 1: 180 Deg" from a line that names a channel; empty for any other line.
std::string channel_in(std::string_view line) {
  const std::size_t at = lower(line).find("chan ");
  if (at == std::string::npos) return {};
  const std::size_t colon = line.find(':', at);
  constexpr std::size_t kFar = 10;
  if (colon == std::string_view::npos || colon > at + kFar) return {};
  const std::size_t from = std::min(line.find_first_not_of(' ', colon + 1), line.size());
  return collapsed(line.substr(at, std::min(line.find("  ", from), line.size()) - at));
}

/// Returns the unit in the usual notation: "cm/s^2" for "cm/sec/sec".
std::string unit_of(std::string_view text) {
  const std::string word = collapsed(lower(text));
  static constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"cm/sec2", "cm/s^2"},  {"cm/sec/sec", "cm/s^2"}, {"cm/s/s", "cm/s^2"},
      {"cm/s**2", "cm/s^2"},  {"cm/s2", "cm/s^2"},      {"cm/sec**2", "cm/s^2"},
      {"cm/sec^2", "cm/s^2"}, {"cm/s^2", "cm/s^2"},     {"gal", "cm/s^2"},
      {"cm/sec", "cm/s"},     {"cm/s", "cm/s"},         {"cm", "cm"},
      {"m/s2", "m/s^2"},      {"m/s/s", "m/s^2"},       {"m/s^2", "m/s^2"},
      {"m/sec2", "m/s^2"},    {"m/s", "m/s"},           {"g", "g"},
      {"mm/s2", "mm/s^2"},    {"mm/s/s", "mm/s^2"},     {"m", "m"},
  };
  std::size_t most = 0;
  std::string unit;
  for (const auto& [written, meant] : kUnits) {
    // Takes the longest known unit with which the text begins, as a whole word.
    if (!word.starts_with(written) || written.size() <= most) continue;
    if (word.size() > written.size() &&
        std::string_view(" .,;()").find(word[written.size()]) == std::string_view::npos)
      continue;
    most = written.size();
    unit = meant;
  }
  return unit;
}

Column column(const std::string& name, const std::string& unit, std::vector<double> values) {
  return {.header = unit.empty() ? name : name + " [" + unit + "]",
          .name = name,
          .unit = unit,
          .values = std::move(values)};
}

Column time_column(std::size_t count, double step) {
  std::vector<double> time;
  time.reserve(count);
  for (std::size_t i = 0; i < count; ++i) time.push_back(static_cast<double>(i) * step);
  return column("time", "s", std::move(time));
}

void leave_out(Columns& table, const Wanted& wanted) {
  for (std::size_t c = 0; wanted && c < table.columns.size(); ++c)
    if (!wanted(table, c)) table.columns[c].values = {};
}

class RecordReader {
 public:
  RecordReader(std::string_view text, const std::filesystem::path& name)
      : lines(text), name_(name) {}

  [[noreturn]] void corrupt(const std::string& why) const {
    throw FileError(FileError::Kind::corrupt, name_, Place{.line = lines.number}, why);
  }
  /// Reads `count` numbers in columns of `width`, or separated by blanks if `width` is 0.
  std::vector<double> numbers(double count, std::size_t width) {
    std::vector<double> out;
    const auto most = static_cast<std::size_t>(count);
    while (out.size() < most) {
      if (!lines.next())
        corrupt("the file ends after " + std::to_string(out.size()) + " of " +
                std::to_string(most) +
                " numbers: it is truncated, or its number of points is wrong");
      take(lines.line, width, most, out);
    }
    return out;
  }

  Lines lines;

 private:
  void take(std::string_view line, std::size_t width, std::size_t most,
            std::vector<double>& out) const {
    while (true) {
      const std::size_t from = line.find_first_not_of(" \t");
      if (from == std::string_view::npos) return;
      std::size_t end = std::min(line.find_first_of(" \t", from), line.size());
      if (width > 0) end = std::min(width, line.size());
      const std::string word = collapsed(line.substr(0, end));
      line.remove_prefix(end);
      if (word.empty()) continue;
      const auto value = parse_number(word);
      if (!value) corrupt("'" + printable(in_utf8(word)).substr(0, 40) + "' is not a number");
      if (out.size() == most)
        corrupt("more numbers than the " + std::to_string(most) +
                " declared: correct the number of points in the header");
      out.push_back(*value);
    }
  }

  const std::filesystem::path& name_;
};

bool is_valid_sampling(double points, double step) {
  return points >= 2.0 && points <= kMostPoints && points == std::floor(points) &&
         std::isfinite(step) && step > 0.0;
}

}  // namespace

Columns parse_peer(std::string bytes, const std::filesystem::path& name, const Wanted& wanted) {
  RecordReader in(bytes, name);
  constexpr int kHeaderLines = 12;
  std::string quantity = "acceleration", unit;
  double points = 0.0, step = 0.0;
  while (!(points > 0.0)) {
    if (in.lines.number == kHeaderLines || !in.lines.next())
      throw FileError(FileError::Kind::corrupt, name,
                      "no line of its header gives the number of points and the time step, as "
                      "\"NPTS= 3930, DT= .00500 SEC\"");
    const std::string line = lower(in.lines.line);
    if (line.find("npts") != std::string::npos && line.find("dt") != std::string::npos) {
      const std::vector<double> found = numbers_in(line);
      if (found.size() < 2 || !is_valid_sampling(found[0], found[1]))
        in.corrupt("'" + printable(in_utf8(collapsed(in.lines.line))) +
                   "' gives no number of points and time step: expected \"NPTS= 3930, DT= .00500 "
                   "SEC\"");
      points = found[0];
      step = found[1];
      continue;
    }
    for (const char* word : {"acceleration", "velocity", "displacement"})
      if (line.find(std::string(word) + " time") != std::string::npos) quantity = word;
    if (const auto of = line.find("units of "); of != std::string::npos)
      unit = unit_of(std::string_view(line).substr(of + 9));
  }
  Columns out{.file = name.string()};
  std::vector<double> values = in.numbers(points, 0);
  while (in.lines.next())
    if (!collapsed(in.lines.line).empty())
      in.corrupt("more lines after the " + std::to_string(values.size()) +
                 " numbers declared: correct NPTS in the header");
  out.columns.push_back(time_column(values.size(), step));
  out.columns.push_back(column(quantity, unit, std::move(values)));
  leave_out(out, wanted);
  return out;
}

Columns parse_csmip(std::string bytes, const std::filesystem::path& name, const Wanted& wanted) {
  static constexpr std::pair<std::string_view, std::string_view> kQuantities[] = {
      {"points of accel data", "acceleration"},
      {"points of veloc data", "velocity"},
      {"points of displ data", "displacement"}};
  constexpr std::size_t kWidth = 10;  // used if the header gives no width
  RecordReader in(bytes, name);
  Columns out{.file = name.string()};
  std::vector<std::string> channels;  // one per column except time
  std::string channel;
  double common_points = 0.0, common_step = 0.0;
  while (in.lines.next()) {
    const std::string line = lower(in.lines.line);
    if (const std::string found = channel_in(in.lines.line); !found.empty()) channel = found;
    const auto* found = std::ranges::find_if(
        kQuantities, [&](const auto& q) { return line.find(q.first) != std::string::npos; });
    if (found == std::end(kQuantities)) continue;
    const auto spaced = line.find("spaced at");
    const std::vector<double> before = numbers_in(line.substr(0, line.find(found->first)));
    const std::vector<double> after =
        spaced == std::string::npos ? std::vector<double>() : numbers_in(line.substr(spaced));
    if (before.empty() || after.empty() || !is_valid_sampling(before.back(), after[0]))
      in.corrupt(
          "gives no number of points and time step: expected \"N points of accel data equally "
          "spaced at DT sec, in cm/sec2. (8f10.5)\"");
    std::size_t width = kWidth;
    const auto format = line.rfind('(');
    if (const auto f = format == std::string::npos ? format : line.find('f', format);
        f != std::string::npos)
      if (const auto w = numbers_in(line.substr(f + 1)); !w.empty() && w[0] >= 2.0 && w[0] < 80.0)
        width = static_cast<std::size_t>(w[0]);
    const auto in_unit = line.find(" in ", spaced);
    const std::string unit =
        in_unit == std::string::npos ? "" : unit_of(std::string_view(line).substr(in_unit + 4));
    std::vector<double> values = in.numbers(before.back(), width);
    if (out.columns.empty()) {
      common_points = before.back();
      common_step = after[0];
      out.columns.push_back(time_column(values.size(), common_step));
    }
    if (before.back() != common_points || after[0] != common_step) {
      out.others.push_back(std::string(found->second) + ", " + channel +
                           " (time step or number of points differs: cut the channel into a "
                           "separate file)");
      continue;
    }
    channels.push_back(channel);
    out.columns.push_back(column(std::string(found->second), unit, std::move(values)));
  }
  if (out.columns.empty())
    throw FileError(
        FileError::Kind::foreign, name,
        "holds no line \"N points of accel data equally spaced at DT sec\": it is not a "
        "corrected record (volume 2) of CSMIP");
  if (std::ranges::count(channels, channels[0]) < std::ssize(channels))
    for (std::size_t c = 1; c < out.columns.size(); ++c) {
      const Column& of = out.columns[c];
      out.columns[c] = column(of.name + ", " + in_utf8(channels[c - 1]), of.unit, of.values);
    }
  leave_out(out, wanted);
  return out;
}

}  // namespace wheeltap::io
