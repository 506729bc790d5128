#include "signals/record.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "io/delimited_text.hpp"
#include "signals/units.hpp"

namespace wheeltap::signals {

namespace {

using io::Column;
using io::FileError;

[[noreturn]] void fail(const Record& record, io::Place place, const std::string& reason) {
  throw FileError(FileError::Kind::corrupt, record.file, std::move(place), reason);
}

/// A column's values, which must have been read.
const Column& values_of(const Record& record, int column) {
  const Column& source = record.columns.at(static_cast<std::size_t>(column));
  if (std::ssize(source.values) != record.samples())
    throw std::invalid_argument("column '" + source.header + "' of " + record.file +
                                " was not asked for when the record was read");
  return source;
}

/// By how much a printed value may differ from the one meant.
double resolution(const Column& column, double value) {
  if (column.digits < 0) return 0.0;
  const double by_point = std::pow(10.0, -column.decimals);
  if (value == 0.0) return by_point;
  return std::max(by_point,
                  std::pow(10.0, std::floor(std::log10(std::abs(value))) - column.digits + 1));
}

std::string show(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

bool is_time(const Column& column) {
  std::string name = column.name;
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return name == "t" || name.starts_with("time");
}

/// What a case may call a column by: see Columns::find.
io::Wanted named(std::vector<std::string> names) {
  if (names.empty()) return {};
  return [names = std::move(names)](const io::Columns& table, std::size_t i) {
    const Column& column = table.columns[i];
    return is_time(column) || std::ranges::any_of(names, [&](const std::string& name) {
             return name == column.header || name == column.name || name == std::to_string(i + 1);
           });
  };
}

}  // namespace

int Record::find_time() const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (is_time(columns[i])) return static_cast<int>(i);
  return -1;
}

Record parse_record(std::string bytes, const std::filesystem::path& name,
                    std::vector<std::string> columns) {
  return Record{io::parse_delimited_text(std::move(bytes), name, named(std::move(columns)))};
}

Record read_record(const std::filesystem::path& path, std::vector<std::string> columns,
                   std::span<const io::Format> known) {
  return Record{io::read_columns(path, named(std::move(columns)), known)};
}

double sample_rate_hz(const Record& record, int time_column, std::optional<double> stated,
                      std::optional<double> scale) {
  const Column& column = values_of(record, time_column);
  const std::vector<double>& t = column.values;
  const io::Place whole{.column = time_column + 1, .header = column.header};
  if (t.size() < 2) fail(record, whole, "one sample has no sampling rate");
  if (!scale && !column.unit.empty()) {
    const auto unit = find_unit(column.unit);
    if (!unit || unit->dimension != Dimension::time)
      fail(record, whole,
           "time is in '" + column.unit + "', must be one of " + known_units(Dimension::time) +
               ", or have a \"scale\" in the case");
    scale = unit->si;
  }
  const std::string unit = column.unit.empty() ? "s" : column.unit;
  for (std::size_t n = 0; n < t.size(); ++n)
    if (!std::isfinite(t[n]))
      fail(record, record.place(n, time_column), "time is not a finite number");
  const auto steps = static_cast<double>(t.size() - 1);
  const double mean = (t.back() - t.front()) / steps;
  std::vector<double> sorted(t.size() - 1);
  for (std::size_t n = 1; n < t.size(); ++n) sorted[n - 1] = t[n] - t[n - 1];
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double median = sorted[sorted.size() / 2];
  bool uneven = !(mean > 0.0);
  for (std::size_t n = 1; n < t.size() && !uneven; ++n) {
    const double off = std::abs(t[n] - t[n - 1] - mean);
    // The digits are asked only where it matters: their powers of ten take longer than all else.
    uneven = off > 1e-3 * mean && off > 1e-3 * mean + 1.01 * resolution(column, t[n]);
  }
  // Where a step is as small as the digits printed, rounding could explain a missing row; but then
  // not in one step of hundreds only.
  const auto odd = std::count_if(sorted.begin(), sorted.end(), [&](double step) {
    return std::abs(step - median) > 0.5 * median;
  });
  uneven = uneven || (odd > 0 && 50 * odd < std::ssize(sorted));
  if (uneven) {
    // A gap shifts the mean, not the median: the step farthest from the median is the one to name.
    std::size_t worst = 1;
    for (std::size_t n = 1; n < t.size(); ++n)
      if (std::abs(t[n] - t[n - 1] - median) > std::abs(t[worst] - t[worst - 1] - median))
        worst = n;
    fail(record, record.place(worst, time_column),
         "time goes from " + show(t[worst - 1]) + " to " + show(t[worst]) + " " + unit +
             ", must advance by the same step everywhere (" + show(median) + " " + unit +
             " elsewhere)");
  }
  const double rate = 1.0 / (mean * scale.value_or(1.0));
  const double rounding = 2.0 * resolution(column, t.back()) / (steps * mean);
  if (stated && !(std::abs(*stated / rate - 1.0) <= 1e-3 + rounding))
    fail(record, whole,
         "says " + show(rate) + " Hz, which contradicts the stated sampling rate of " +
             show(*stated) + " Hz");
  return rate;
}

std::vector<double> window(const Record& record, int column, int begin, int end) {
  if (begin < 0 || begin >= end || end > record.samples())
    fail(record, {},
         "samples [" + std::to_string(begin) + ", " + std::to_string(end) +
             "), must be a window within [0, " + std::to_string(record.samples()) + ")");
  const Column& source = values_of(record, column);
  std::vector<double> values(source.values.begin() + begin, source.values.begin() + end);
  for (std::size_t n = 0; n < values.size(); ++n)
    if (!std::isfinite(values[n]))
      fail(record, record.place(n + static_cast<std::size_t>(begin), column),
           "not a finite number");
  return values;
}

std::string record_csv(const Record& record, const std::string& comment, int digits) {
  std::string text = "# " + comment + "\n";
  const auto quoted = [](const std::string& header) {
    if (header.find_first_of(",\"") == std::string::npos) return header;
    std::string out = "\"";
    for (const char c : header) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
  };
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    text += (c > 0 ? "," : "") + quoted(record.columns[c].header);
  }
  text += '\n';
  char cell[40];
  for (std::size_t n = 0; n < record.columns[0].values.size(); ++n) {
    for (std::size_t c = 0; c < record.columns.size(); ++c) {
      std::snprintf(cell, sizeof cell, "%s%.*g", c > 0 ? "," : "", digits,
                    record.columns[c].values[n]);
      text += cell;
    }
    text += '\n';
  }
  return text;
}

}  // namespace wheeltap::signals
