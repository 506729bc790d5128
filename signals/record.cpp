#include "signals/record.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "io/tables/delimited_text.hpp"
#include "signals/spectra.hpp"
#include "signals/units.hpp"

namespace wheeltap::signals {

namespace {

using io::Column;
using io::FileError;

constexpr double kLongestGap = 5.0;  // largest time step that is interpolated, in median steps

[[noreturn]] void fail(const Record& record, io::Place place, const std::string& reason) {
  throw FileError(FileError::Kind::corrupt, record.file, std::move(place), reason);
}

/// Returns the values of a column. Throws an exception if the values were not read.
const Column& values_of(const Record& record, int column) {
  const Column& source = record.columns.at(static_cast<std::size_t>(column));
  if (std::ssize(source.values) != record.samples())
    throw std::invalid_argument("column '" + source.header + "' of " + record.file +
                                " was not requested when the record was read");
  return source;
}

/// Returns the largest rounding error of a printed value.
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

/// True for a name of a time column. Names that do not begin with "time" are from other languages,
/// loggers and phones.
bool is_time(const Column& column) {
  std::string name = column.name;
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  std::erase_if(name, [](char c) { return c == '_' || c == ' ' || c == '-' || c == '/'; });
  if (name == "t" || name.starts_with("time")) return true;
  const std::optional<Unit> unit = find_unit(unit_of(column));
  if (unit && unit->dimension != Dimension::time) return false;
  static constexpr std::string_view kNames[] = {
      "ts",           "datetime",     "dateandtime",  "date&time",
      "datumzeit",    "datumuhrzeit", "zeit",         "uhrzeit",
      "zeitstempel",  "messzeit",     "temps",        "horodatage",
      "tiempo",       "tempo",        "tijd",         "tid",
      "elapsed",      "elapsedtime",  "relativetime", "secondselapsed",
      "seconds",      "millis",       "micros",       "microseconds",
      "nanos",        "nanoseconds",  "us",           "usec",
      "milliseconds", "epoch",        "unixtime",     "unixtimestamp",
      "loggingtime",  "sampletime",   "xvalue",       "xaxis",
      "ttime",        "ms",           "msec",         "tms",
      "tus",          "tns",          "t\xC2\xB5s",   "t\xCE\xBCs",
      "ts1",          "epochms",      "epochus",      "epochns",
      "utc",          "reltime",      "abstime",      "systime"};
  if (std::ranges::find(kNames, name) != std::end(kNames)) return true;
  return name.starts_with("zeit") || name.starts_with("elapsedtime");
}

/// True for a column "Date" or "Datum" with days since 1900 or since year 0, with fractions.
bool is_serial_date(const Column& column) {
  std::string name = column.name;
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if ((name != "date" && name != "datum" && name != "datenum") || column.values.size() < 2)
    return false;
  const double first = column.values.front(), last = column.values.back();
  return ((first >= 2e4 && first < 8e4) || (first >= 7e5 && first < 8e5)) && last > first &&
         last - first < 1e-3 * static_cast<double>(column.values.size());
}

bool increases_by_fractions(const Column& column) {
  const std::vector<double>& t = column.values;
  if (t.size() < 5 || column.cells != io::CellKind::number) return false;
  const double mean = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  if (!(mean > 0.0) || mean == std::round(mean)) return false;
  for (std::size_t n = 1; n < t.size(); ++n)
    if (!(std::abs(t[n] - t[n - 1] - mean) <= 1e-2 * mean + 1.01 * resolution(column, t[n])))
      return false;
  return true;
}

bool is_one_of(const std::vector<std::string>& names, const Column& column, std::size_t place) {
  return std::ranges::any_of(names, [&](const std::string& name) {
    return name == column.header || name == column.name || name == std::to_string(place + 1);
  });
}

/// Selects the columns that a case names; see Columns::find.
io::Wanted named(RecordReading reading) {
  if (reading.columns.empty() && reading.ignored.empty()) return {};
  return [reading = std::move(reading)](const io::Columns& table, std::size_t i) {
    const Column& column = table.columns[i];
    if (is_one_of(reading.columns, column, i)) return true;
    if (is_one_of(reading.ignored, column, i)) return false;
    if (reading.columns.empty()) return true;
    return column.cells == io::CellKind::stamp ||
           (is_time(column) && column.cells != io::CellKind::text);
  };
}

/// Returns the duration of one unit of a time column [s], and stores the basis of this unit.
double seconds_in_one(const Record& record, int time_column, double median, Sampling& out) {
  const Column& column = record.columns[static_cast<std::size_t>(time_column)];
  if (column.cells == io::CellKind::stamp) {
    out.basis = Sampling::Basis::stamps;
    return 1.0;
  }
  out.unit = time_unit_of(column);
  const double first = std::abs(column.values.front());
  if (out.unit.empty()) {
    out.basis = Sampling::Basis::epoch;
    // If these counts were seconds, the dates would be after the year 5000.
    if (first >= 1e11 && first < 1e14) return out.unit = "ms", 1e-3;
    if (first >= 1e14 && first < 1e17) return out.unit = "us", 1e-6;
    if (first >= 1e17 && first < 1e20) return out.unit = "ns", 1e-9;
    // If these values were seconds, the sampling rate would be 70 kHz or more, and the record would
    // begin days after the start of the clock.
    const bool spreadsheet = first >= 2e4 && first < 8e4, year_zero = first >= 7e5 && first < 8e5;
    if ((spreadsheet || year_zero) && median > 0.0 && median < 1.2 / 86400.0) {
      out.basis = Sampling::Basis::days;
      out.unit = "d";
      return 86400.0;
    }
    out.basis = Sampling::Basis::assumed;
    out.unit = "s";
    out.doubtful_unit = median >= 2.0 && std::ranges::all_of(column.values, [](double t) {
                          return t == std::round(t);
                        });
    return 1.0;
  }
  const Conversion conversion = conversion_of(out.unit, Dimension::time);
  if (conversion.basis != Conversion::Basis::unit)
    fail(record, {.column = time_column + 1, .header = column.header},
         "time is in '" + out.unit + "', must be one of " + known_units(Dimension::time) +
             ", or have a \"scale\" in the case");
  out.basis = Sampling::Basis::unit;
  return conversion.factor;
}

}  // namespace

int Record::find_time() const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (is_time(columns[i]) && columns[i].cells != io::CellKind::text) return static_cast<int>(i);
  // If the table has a date column and a time-of-day column, the time column is the latter.
  int stamps = -1;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].cells != io::CellKind::stamp || columns[i].values.empty()) continue;
    if (stamps < 0) stamps = static_cast<int>(i);
    if (columns[i].values.back() != columns[i].values.front()) return static_cast<int>(i);
  }
  if (stamps >= 0) return stamps;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (is_serial_date(columns[i])) return static_cast<int>(i);
  // In a text without names, the time column is a first column that increases evenly. A column that
  // increases by whole numbers is excluded, because it could count rows.
  const bool unnamed = layout && layout->used.header.value_or(1) == 0;
  return unnamed && columns.size() > 1 && increases_by_fractions(columns.front()) ? 0 : -1;
}

Record parse_record(std::string bytes, const std::filesystem::path& name,
                    std::vector<std::string> columns) {
  return Record{
      io::parse_delimited_text(std::move(bytes), name, named({.columns = std::move(columns)}))};
}

Record read_record(const std::filesystem::path& path, RecordReading reading,
                   std::span<const io::Format> known) {
  const io::TextLayout layout = reading.layout;
  const io::ArrayLayout arrays = reading.arrays;
  return Record{io::read_columns(path, named(std::move(reading)), known, layout, arrays)};
}

Sampling sampling_of(const Record& record, int time_column, std::optional<double> stated,
                     std::optional<double> scale) {
  constexpr double kEven = 1e-3;        // largest jitter that is not reported, in steps
  constexpr double kMostJitter = 1e-2;  // largest jitter of an even record, in steps
  const Column& column = values_of(record, time_column);
  const std::vector<double>& t = column.values;
  const io::Place whole{.column = time_column + 1, .header = column.header};
  if (t.size() < 2) fail(record, whole, "a single sample has no sampling rate");
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
  Sampling out;
  if (scale) {
    out.basis = Sampling::Basis::scale;
  } else {
    scale = seconds_in_one(record, time_column, median, out);
  }
  const std::string unit = out.unit.empty() ? "s" : out.unit;
  bool uneven = !(mean > 0.0);
  for (std::size_t n = 1; n < t.size() && !uneven; ++n) {
    const double off = std::abs(t[n] - t[n - 1] - mean);
    // Checks the printed digits only if necessary, because the powers of ten take most of the run
    // time.
    if (off <= kEven * mean) continue;
    const double printed = 1.01 * resolution(column, t[n]);
    uneven = off > kMostJitter * mean + printed;
    if (off > kEven * mean + printed) out.jitter = std::max(out.jitter, (off - printed) / mean);
  }
  // If a time step is as small as the printed resolution, rounding could explain the difference
  // that a missing row causes. Rounding cannot explain a difference in only one of hundreds of
  // steps.
  const auto odd = std::count_if(sorted.begin(), sorted.end(), [&](double step) {
    return std::abs(step - median) > 0.5 * median;
  });
  uneven = uneven || (odd > 0 && 50 * odd < std::ssize(sorted));
  if (uneven) {
    // Time stamps of whole seconds for faster samples: a stated rate must agree with the number of
    // rows.
    if (median == 0.0 && mean > 0.0) {
      const double all = t.back() - t.front(), coarse = *std::ranges::max_element(sorted);
      const double seconds = *scale;
      const bool rises = *std::ranges::min_element(sorted) >= 0.0;
      const bool fits =
          stated && rises && std::abs(steps / *stated - all * seconds) <= 2.0 * coarse * seconds;
      if (fits) {
        out.rate_hz = *stated;
        out.basis = Sampling::Basis::stated;
        return out;
      }
      // Counts rows between changes of the stamp. The first and the last stamp may cover fewer
      // samples.
      std::size_t from = 1, to = t.size() - 1;
      while (t[from] == t[from - 1]) ++from;
      while (t[to] == t[to - 1]) --to;
      const double rate = to > from && t[to] > t[from]
                              ? static_cast<double>(to - from) / ((t[to] - t[from]) * seconds)
                              : steps / (all * seconds);
      fail(record, whole,
           "several consecutive rows have the same time" +
               (stated ? ", and their number contradicts the stated " + show(*stated) + " Hz"
                       : ": state \"sample_rate\" (about " + show(rate) + ")") +
               (rises ? "" : "; time also goes backwards"));
    }
    // A gap changes the mean step, but not the median step. The message names the step farthest
    // from the median.
    std::size_t worst = 1;
    for (std::size_t n = 1; n < t.size(); ++n)
      if (std::abs(t[n] - t[n - 1] - median) > std::abs(t[worst] - t[worst - 1] - median))
        worst = n;
    const std::string what = "time goes from " + show(t[worst - 1]) + " to " + show(t[worst]) +
                             " " + unit + ", but must advance by the same step everywhere (" +
                             show(median) + " " + unit + " elsewhere)";
    const double step = t[worst] - t[worst - 1];
    std::string remedy = "state \"resample\": true to interpolate at a constant rate";
    if (step == 0.0) remedy = "delete the repeated row";
    if (step < 0.0) remedy = "cut the file there if a new measurement begins, or delete the row";
    if (step > kLongestGap * median)
      remedy = "cut the file there: the gap is too long to interpolate";
    fail(record, record.place(worst, time_column), what + "; " + remedy);
  }
  if (out.jitter > 0.0)
    for (std::size_t n = 1; n < t.size(); ++n)
      out.off_grid =
          std::max(out.off_grid, std::abs((t[n] - t.front()) / mean - static_cast<double>(n)));
  out.rate_hz = 1.0 / (mean * *scale);
  const double rounding = 2.0 * resolution(column, t.back()) / (steps * mean);
  if (stated && !(std::abs(*stated / out.rate_hz - 1.0) <= 1e-3 + rounding))
    fail(record, whole,
         "states " + show(out.rate_hz) + " Hz, which contradicts the stated sampling rate of " +
             show(*stated) + " Hz");
  return out;
}

double sample_rate_hz(const Record& record, int time_column, std::optional<double> stated,
                      std::optional<double> scale) {
  return sampling_of(record, time_column, stated, scale).rate_hz;
}

namespace {

/// Computes the second derivatives of the natural cubic spline through (x, y). The system of
/// equations is tridiagonal and diagonally dominant; it is solved by elimination.
std::vector<double> curvatures(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> m(n, 0.0), above(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = x[i] - x[i - 1], right = x[i + 1] - x[i];
    const double slope = (y[i + 1] - y[i]) / right - (y[i] - y[i - 1]) / left;
    const double pivot = 2.0 * (left + right) - left * above[i - 1];
    above[i] = right / pivot;
    m[i] = (6.0 * slope - left * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m[i] -= above[i] * m[i + 1];
  return m;
}

}  // namespace

Record resampled(const Record& record, int time_column, std::optional<double> rate_hz,
                 std::optional<double> scale) {
  const Column& column = values_of(record, time_column);
  std::vector<double> t = column.values;
  if (t.size() < 4) fail(record, {}, "too few samples to interpolate");
  std::vector<double> steps(t.size() - 1);
  for (std::size_t n = 1; n < t.size(); ++n) {
    steps[n - 1] = t[n] - t[n - 1];
    if (!(steps[n - 1] > 0.0))
      fail(record, record.place(n, time_column), "time does not increase: delete the row");
  }
  std::vector<double> sorted = steps;
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
  const double median = sorted[sorted.size() / 2];
  for (std::size_t n = 1; n < t.size(); ++n)
    if (steps[n - 1] > kLongestGap * median)
      fail(record, record.place(n, time_column),
           "a gap of " + show(steps[n - 1] / median) +
               " steps is too long to interpolate: use a part of the file without this gap");
  Sampling ignored;
  const double seconds = scale ? *scale : seconds_in_one(record, time_column, median, ignored);
  const double begin = t.front();
  for (double& x : t) x = (x - begin) * seconds;
  const double rate = rate_hz.value_or(static_cast<double>(t.size() - 1) / t.back());
  const auto samples_at = [&](double hz) {
    return static_cast<std::size_t>(std::floor(t.back() * hz * (1.0 + 1e-12))) + 1;
  };
  const std::size_t count = samples_at(rate);
  // For a lower rate, interpolates at a multiple of this rate; the filter of decimate() then
  // removes the frequencies that would alias.
  const double mean_rate = static_cast<double>(t.size() - 1) / t.back();
  constexpr double kLower = 1.02;  // a nominal rate may differ slightly from the mean rate
  const double ratio = std::min(mean_rate / rate, static_cast<double>(t.size()));
  const int factor = ratio > kLower ? static_cast<int>(std::ceil(ratio * (1.0 - 1e-6))) : 1;
  const double fine = rate * factor;
  Record out = record;
  for (std::size_t c = 0; c < out.columns.size(); ++c) {
    Column& to = out.columns[c];
    if (to.values.empty()) continue;
    std::vector<double> from = std::move(to.values);
    to.values.assign(count, 0.0);
    to.decimals = to.digits = -1;
    if (static_cast<int>(c) == time_column) {
      for (std::size_t n = 0; n < count; ++n) to.values[n] = static_cast<double>(n) / rate;
      to.unit = "s";
      to.cells = io::CellKind::number;
      continue;
    }
    for (std::size_t n = 0; n < from.size(); ++n)
      if (!std::isfinite(from[n]))
        fail(record, record.place(n, static_cast<int>(c)), "not a finite number");
    const std::vector<double> m = curvatures(t, from);
    to.values.assign(samples_at(fine), 0.0);
    std::size_t i = 0;
    for (std::size_t n = 0; n < to.values.size(); ++n) {
      const double x = std::min(static_cast<double>(n) / fine, t.back());
      while (i + 2 < t.size() && t[i + 1] < x) ++i;
      const double h = t[i + 1] - t[i], a = (t[i + 1] - x) / h, b = (x - t[i]) / h;
      to.values[n] = a * from[i] + b * from[i + 1] +
                     ((a * a * a - a) * m[i] + (b * b * b - b) * m[i + 1]) * h * h / 6.0;
    }
    if (factor > 1) to.values = decimate(to.values, factor);
    to.values.resize(count, to.values.back());
  }
  // Rows no longer correspond to lines of the file.
  out.first_line = 0;
  out.skipped.clear();
  return out;
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
