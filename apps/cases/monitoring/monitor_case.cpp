#include "apps/cases/monitoring/monitor_case.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/monitoring/series_warnings.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "apps/nearest.hpp"
#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "io/bytes.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/text.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::apps {
namespace {

using identification::monitoring::SeriesFault;

const Pointer kSeries("/series");

struct SeriesColumns {
  std::string time;
  std::vector<std::string> features, sds, covariates;
};

std::vector<std::string> names_at(const CaseFile& file, const char* key) {
  std::vector<std::string> out;
  const Json& series = file.json.at("series");
  if (!series.contains(key) || series.at(key).is_null()) return out;
  for (const Json& one : series.at(key)) out.push_back(text_or_number(one));
  return out;
}

SeriesColumns columns_of(const CaseFile& file) {
  const Json& series = file.json.at("series");
  SeriesColumns out{.time = series.contains("time") ? text_or_number(series.at("time")) : "time",
                    .features = names_at(file, "features"),
                    .sds = names_at(file, "sd"),
                    .covariates = names_at(file, "covariates")};
  if (!out.sds.empty() && out.sds.size() != out.features.size())
    file.refuse(kSeries / "sd", "must have one column for each of the " +
                                    std::to_string(out.features.size()) + " features, or be null");
  return out;
}

/// Refuses a column with two uses: as a covariate, a feature would explain its own change.
void check_uses(const CaseFile& file, const SeriesColumns& columns) {
  std::vector<std::pair<std::string, std::string>> uses = {{columns.time, "\"time\""}};
  const auto add = [&](const std::vector<std::string>& list, const char* key) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      const auto same =
          std::ranges::find(uses, list[i], &std::pair<std::string, std::string>::first);
      if (same != uses.end())
        file.refuse(kSeries / key / i,
                    "the column is also named in " + same->second + ": use each column once");
      uses.emplace_back(list[i], std::string("\"") + key + "\"");
    }
  };
  add(columns.features, "features");
  add(columns.covariates, "covariates");
}

/// The key that names a column, for messages.
Pointer place_of(const SeriesColumns& columns, const std::string& name) {
  const auto in = [&](const std::vector<std::string>& list, const char* key,
                      std::optional<Pointer>& found) {
    for (std::size_t i = 0; i < list.size() && !found; ++i)
      if (list[i] == name) found = kSeries / key / i;
  };
  std::optional<Pointer> found;
  if (columns.time == name) found = kSeries / "time";
  in(columns.features, "features", found);
  in(columns.sds, "sd", found);
  in(columns.covariates, "covariates", found);
  return found.value_or(kSeries / "file");
}

[[noreturn]] void refuse_column(const CaseFile& file, const SeriesColumns& columns,
                                const io::NoSuchColumn& error) {
  file.refuse(place_of(columns, error.column()),
              error.reason() + " in " + error.path().filename().string());
}

/// Removes an incomplete last line: a line without a newline is still being written.
std::string complete_lines(std::string text) {
  text.resize(text.find_last_of('\n') + 1);  // npos + 1 is 0
  return text;
}

signals::Record read_complete_lines(const std::filesystem::path& path,
                                    signals::RecordReading reading) {
  std::string text = io::read_bytes(path);
  const io::Format& format = io::format_of(path, std::string_view(text).substr(0, 512));
  if (format.parse_text == nullptr) return signals::read_record(path, std::move(reading));
  const auto wanted = [&](const io::Columns& table, std::size_t column) {
    return std::ranges::any_of(reading.columns, [&](const std::string& name) {
      return table.find(name) == static_cast<int>(column);
    });
  };
  return signals::Record{
      format.parse_text(complete_lines(std::move(text)), path, wanted, reading.layout)};
}

signals::Record read_table(const CaseFile& file, const SeriesColumns& columns, const char* key,
                           bool following) {
  signals::RecordReading reading{.layout = parse_layout(file, kSeries)};
  reading.columns.push_back(columns.time);
  for (const auto* list : {&columns.features, &columns.sds, &columns.covariates})
    reading.columns.insert(reading.columns.end(), list->begin(), list->end());
  try {
    const auto path = file.resolve(file.json.at("series").at(key).get<std::string>());
    if (following) return read_complete_lines(path, std::move(reading));
    return signals::read_record(path, std::move(reading));
  } catch (const io::NoSuchColumn& error) {
    refuse_column(file, columns, error);
  } catch (const io::FileError& error) {
    throw Failure(error.kind() == io::FileError::Kind::missing ? Exit::no_input : Exit::bad_input,
                  error.what());
  }
}

/// Throws Failure with one line about a row of the table.
[[noreturn]] void refuse_row(const signals::Record& table, int row, int column,
                             const std::string& message) {
  throw Failure(Exit::bad_input,
                io::printable(io::FileError(io::FileError::Kind::corrupt, table.file,
                                            table.place(index(row), column), message)
                                  .what()));
}

/// Refuses a column without numbers.
void require_numbers(const signals::Record& table, int column) {
  const io::Column& cells = table.columns[index(column)];
  if (cells.cells != io::CellKind::number ||
      std::ranges::all_of(cells.values, [](double x) { return std::isnan(x); }))
    refuse_row(table, 0, column,
               "the column has no numbers, only empty cells, text or dates: name another column, "
               "correct the cells, or remove this column from the case");
}

TimeAxis time_axis(const CaseFile& file, const signals::Record& table, int column) {
  const io::Column& time = table.columns[index(column)];
  const Json& series = file.json.at("series");
  if (time.cells == io::CellKind::text)
    refuse_row(table, 0, column,
               "time is neither a number nor an ISO 8601 date: state \"time_format\" in /series, "
               "for example \"%d.%m.%Y %H:%M\"");
  if (time.cells == io::CellKind::stamp) {
    if (series.contains("time_unit"))
      file.refuse(kSeries / "time_unit", "the time column holds dates: remove \"time_unit\"");
    const auto start = table.layout ? io::read_stamp(table.layout->start).stamp : std::nullopt;
    if (!start)
      refuse_row(table, 0, column,
                 "the first date cannot be read: use ISO 8601, 2026-03-01T10:00Z");
    return {.hours_per_unit = 1.0 / 3600.0,
            .unit = "date",
            .start_nanoseconds = start->nanoseconds,
            .has_zone = table.layout->start_has_zone};
  }
  const std::string unit = series.value("time_unit", std::string("h"));
  const double hours = unit == "s"     ? 1.0 / 3600.0
                       : unit == "min" ? 1.0 / 60.0
                       : unit == "d"   ? 24.0
                                       : 1.0;
  return {.hours_per_unit = hours, .unit = unit};
}

void read_features(const signals::Record& table, const SeriesColumns& columns,
                   MonitorCaseFile& out) {
  const auto n = static_cast<Eigen::Index>(table.rows());
  const auto p = static_cast<Eigen::Index>(columns.features.size());
  auto& series = out.series;
  out.features.resize(n, p);
  series.features.resize(n, p);
  series.sds.resize(columns.sds.empty() ? 0 : n, columns.sds.empty() ? 0 : p);
  for (Eigen::Index j = 0; j < p; ++j) {
    const int column = table.find(columns.features[index(j)]);
    const io::Column& values = table.columns[index(column)];
    series.feature_names.push_back(values.header);
    require_numbers(table, column);
    const int sd = columns.sds.empty() ? -1 : table.find(columns.sds[index(j)]);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double x = values.values[index(i)];
      if (x <= 0.0 || std::isinf(x))
        refuse_row(table, static_cast<int>(i), column,
                   base::number(x) +
                       ": a feature must be positive and finite; leave the cell empty if the "
                       "value is missing");
      out.features(i, j) = x;
      series.features(i, j) = std::log(x);
      if (sd < 0) continue;
      const double s = table.columns[index(sd)].values[index(i)];
      if (std::isfinite(x) && !std::isnan(s) && !(s > 0.0 && std::isfinite(s)))
        refuse_row(table, static_cast<int>(i), sd,
                   base::number(s) + ": a standard deviation must be positive and finite");
      series.sds(i, j) = s / x;
    }
  }
}

void read_covariates(const signals::Record& table, const SeriesColumns& columns,
                     MonitorCaseFile& out) {
  const auto n = static_cast<Eigen::Index>(table.rows());
  out.series.covariates.resize(n, static_cast<Eigen::Index>(columns.covariates.size()));
  for (std::size_t c = 0; c < columns.covariates.size(); ++c) {
    const int column = table.find(columns.covariates[c]);
    const io::Column& values = table.columns[index(column)];
    out.series.covariate_names.push_back(values.header);
    require_numbers(table, column);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double u = values.values[index(i)];
      if (std::isinf(u)) refuse_row(table, static_cast<int>(i), column, "is not finite");
      out.series.covariates(i, static_cast<Eigen::Index>(c)) = u;
    }
  }
}

void read_times(const signals::Record& table, const SeriesColumns& columns, MonitorCaseFile& out) {
  const int column = table.find(columns.time);
  out.time = time_axis(out.file, table, column);
  const std::vector<double>& times = table.columns[index(column)].values;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]))
      refuse_row(table, static_cast<int>(i), column,
                 "time is missing or not a number: give every row a time, or remove the row");
    out.series.hours.push_back(times[i] * out.time.hours_per_unit);
    if (i == 0 || times[i] > times[i - 1]) continue;
    const std::string now = out.time.text(out.series.hours[i]);
    refuse_row(table, static_cast<int>(i), column,
               times[i] == times[i - 1]
                   ? now + ": the time equals that of the previous row: remove the repeated row" +
                         (out.time.unit == "date" ? ", or state the time zone of each time if "
                                                    "clocks were set back"
                                                  : "")
                   : now + ": time goes backwards, from " + out.time.text(out.series.hours[i - 1]) +
                         ": sort the rows by time" +
                         (out.time.unit == "date" ? ", or state the time zone of each time if "
                                                    "clocks were set back"
                                                  : ""));
  }
}

void read_learning(MonitorCaseFile& out) {
  const Pointer where = Pointer("/learning") / "until";
  const Json& until = out.file.json.at(where);
  double hours = 0.0;
  if (out.time.unit == "date") {
    if (!until.is_string())
      out.file.refuse(where, "must be a date, as the times of the series are, for example \"" +
                                 out.time.text(out.series.hours.back()) + "\"");
    const auto stamp = io::read_stamp(until.get<std::string>()).stamp;
    if (!stamp || !stamp->has_date)
      out.file.refuse(where, "must be an ISO 8601 date, for example \"2026-03-01T00:00Z\"");
    if (stamp->has_zone && !out.time.has_zone)
      out.file.refuse(where,
                      "states a time zone, but the times of the series state none: write this date "
                      "without a time "
                      "zone as well");
    hours = static_cast<double>(stamp->nanoseconds - *out.time.start_nanoseconds) / 3.6e12;
  } else {
    if (!until.is_number())
      out.file.refuse(where, "must be a number in " + out.time.unit + ", as the times are");
    hours = until.get<double>() * out.time.hours_per_unit;
    // If the rows are numbered tests, the given number is that of the last healthy test.
    if (out.tests && out.time.unit == "row") hours += 0.5;
  }
  const auto& times = out.series.hours;
  out.learning_rows = static_cast<int>(std::ranges::lower_bound(times, hours) - times.begin());
  const int fewest = identification::monitoring::kFewestLearningRows;
  if (out.learning_rows < fewest)
    out.file.refuse(where, "only " + std::to_string(out.learning_rows) +
                               " rows are before this time: the training period needs at least " +
                               std::to_string(fewest) + " rows; the series begins at " +
                               out.time.text(times.front()));
  if (out.learning_rows == out.series.rows())
    out.file.refuse(where, "the series ends before this time, at " + out.time.text(times.back()) +
                               ": wait until the training period ends, or give an earlier time");
}

/// The first value of a feature.
double constant_of(const MonitorCaseFile& out, int feature) {
  for (int i = 0; i < out.learning_rows; ++i)
    if (std::isfinite(out.features(i, feature))) return out.features(i, feature);
  return kNaN;
}

/// Reports faults of the series as errors of the case, but a constant covariate as a warning.
void check_series(const SeriesColumns& columns, MonitorCaseFile& out) {
  using Kind = SeriesFault::Kind;
  const Pointer tests =
      kSeries / (out.file.json.at("series").contains("modes") ? "modes" : "records");
  for (const SeriesFault& fault : find_faults(out.series, out.learning_rows)) {
    const auto feature = [&](const std::string& message) {
      if (out.tests)
        out.file.refuse(tests, out.series.feature_names[index(fault.column)] + " " + message);
      out.file.refuse(place_of(columns, columns.features[index(fault.column)]), message);
    };
    switch (fault.kind) {
      case Kind::feature_missing:
        feature(
            "has fewer than " + std::to_string(identification::monitoring::kFewestLearningRows) +
            " values in the training period: name another column, or extend the training period");
        break;
      case Kind::feature_constant:
        feature("is constant in the training period (" +
                base::number(constant_of(out, fault.column)) +
                "): check the sensor, or remove the column from the case");
        break;
      case Kind::covariate_missing:
        out.file.refuse(
            place_of(columns, columns.covariates[index(fault.column)]),
            "has no value in the training period: remove the covariate, or extend the training "
            "period");
      case Kind::covariate_constant:
        out.warnings.push_back(
            "The covariate " + out.series.covariate_names[index(fault.column)] +
            " is constant in the training period: its effect cannot be inferred, and Wheeltap "
            "leaves it out. An alarm may then be an effect of this covariate.");
        break;
      case Kind::sd_not_positive:
        out.file.refuse(place_of(columns, columns.sds[index(fault.column)]),
                        "is missing in a row with a feature value: fill or empty both cells");
      default:
        break;  // times and training period were checked before
    }
  }
}

void read_alarm(MonitorCaseFile& out) {
  const Json alarm = out.file.json.value("alarm", Json::object());
  const bool rows = out.time.unit == "row";
  const auto wrong = [&](const char* key, const char* instead) {
    if (alarm.contains(key))
      out.file.refuse(Pointer("/alarm") / key, std::string(rows ? "times are row numbers: use \""
                                                                : "times have a unit: use \"") +
                                                   instead + "\"");
  };
  auto& options = out.options;
  options.is_calibrated = alarm.value("calibration", std::string("replay")) == "replay";
  if (rows) {
    wrong("false_alarms_per_year", "mean_rows_between_false_alarms");
    wrong("hazard_per_year", "hazard_per_row");
    options.mean_rows_between_false_alarms = alarm.value("mean_rows_between_false_alarms", 1000.0);
    options.change.hazard_per_hour = alarm.value("hazard_per_row", 0.001);
    // No transients: they decay in hours, but rows have no times. They could explain early
    // damage.
    options.change.transients_per_hour = 0.0;
  } else {
    wrong("mean_rows_between_false_alarms", "false_alarms_per_year");
    wrong("hazard_per_row", "hazard_per_year");
    options.false_alarms_per_year = alarm.value("false_alarms_per_year", 0.1);
    options.change.hazard_per_hour =
        alarm.value("hazard_per_year", 0.1) / identification::monitoring::kHoursPerYear;
  }
  const Json& learning = out.file.json.at("learning");
  options.learning.most_hinges = learning.value("hinges", 3);
  options.learning.hinges = options.learning.most_hinges > 0;
  options.learning.lag = learning.value("lag", true);
  // With many correlated covariates, short chains do not agree. For few rows, long chains take
  // seconds.
  constexpr long kFewEntries = 20'000;
  if (static_cast<long>(out.learning_rows) * out.series.feature_count() <= kFewEntries) {
    options.learning.engine_warmup = 8000;
    options.learning.engine_draws = 3000;
  }
}

/// Checks that the series has exactly one source of features.
void check_source(const CaseFile& file) {
  const Json& series = file.json.at("series");
  std::vector<std::string> sources;
  for (const char* key : {"features", "modes", "records"})
    if (series.contains(key)) sources.emplace_back(key);
  if (sources.size() != 1)
    file.refuse(kSeries, sources.empty()
                             ? "must have \"features\" (columns of a table), \"modes\" (files of "
                               "wheeltap modal) or \"records\" (raw records)"
                             : "has both \"" + sources[0] + "\" and \"" + sources[1] +
                                   "\": give only one of the two keys");
  const bool table = sources[0] == "features";
  const auto need = [&](const char* key) {
    if (!series.contains(key)) file.refuse(kSeries / key, "is missing: a table needs this key");
  };
  const auto reject = [&](const char* key, const std::string& why) {
    if (series.contains(key) && !series.at(key).is_null()) file.refuse(kSeries / key, why);
  };
  if (table) {
    need("file");
    need("time");
    reject("times", "is allowed with \"modes\" and \"records\" only: a table has a time column");
    return;
  }
  reject("file", "is allowed with \"features\" only: remove it, or name columns in \"features\"");
  reject("sd", "is allowed with \"features\" only: modes have their own standard deviations");
  for (const char* key : {"time", "time_unit", "covariates"})
    if (!series.contains("times")) reject(key, "needs \"times\", a table of file and time");
}

void read_series_table(const SeriesColumns& columns, const ModesReading& reading,
                       MonitorCaseFile& out) {
  const signals::Record table = read_table(out.file, columns, "file", reading.following);
  if (table.rows() == 0) refuse_row(table, 0, -1, "the table has no rows");
  try {
    read_times(table, columns, out);
    read_features(table, columns, out);
    read_covariates(table, columns, out);
  } catch (const io::NoSuchColumn& error) {
    refuse_column(out.file, columns, error);
  }
  read_learning(out);
}

/// The names in the column "file" of the table of times.
std::vector<std::string> files_of_times(const MonitorCaseFile& out, bool following) {
  const auto path = out.file.resolve(out.file.json.at(kSeries / "times").get<std::string>());
  std::string text = io::read_bytes(path);
  if (following) text = complete_lines(std::move(text));
  const io::DelimitedText table(std::move(text), path, io::FirstRow::header,
                                parse_layout(out.file, kSeries));
  const auto& headers = table.headers();
  const auto found = std::ranges::find(headers, "file", &io::Column::name);
  if (found == headers.end())
    out.file.refuse(kSeries / "times", "has no column \"file\" with the names of the files");
  std::vector<std::string> names;
  for (int i = 0; i < table.rows(); ++i)
    names.push_back(table.cells(i)[index(found - headers.begin())]);
  return names;
}

/// Brings the tests into the order of the table of times.
void order_by_times(const SeriesColumns& columns, const ModesReading& reading, MonitorCaseFile& out,
                    std::vector<MonitoredTest>& tests) {
  const signals::Record table = read_table(out.file, columns, "times", reading.following);
  try {
    read_times(table, columns, out);
    read_covariates(table, columns, out);
  } catch (const io::NoSuchColumn& error) {
    refuse_column(out.file, columns, error);
  }
  const std::vector<std::string> names = files_of_times(out, reading.following);
  std::vector<MonitoredTest> ordered;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<const MonitoredTest*> found = tests_named(names[i], tests);
    if (found.size() != 1)
      refuse_row(table, static_cast<int>(i), -1,
                 found.empty() ? names[i] +
                                     " is not among the files of the series: correct the "
                                     "name, or remove the row"
                               : names[i] +
                                     " names several files of the series: folder and file together "
                                     "must be unique, as in " +
                                     found.front()->name);
    ordered.push_back(*found.front());
  }
  for (const MonitoredTest& test : tests)
    if (!reading.following &&
        std::ranges::none_of(ordered, [&](const auto& o) { return o.name == test.name; }))
      out.file.refuse(kSeries / "times", "has no row for " + io::printable(test.name));
  tests = std::move(ordered);
}

/// Fills in the features: frequencies of the tracked modes; NaN if no mode is assigned.
void fill_tracked(const identification::monitoring::ModeTracker& tracker,
                  const std::vector<identification::monitoring::IdentifiedRecord>& records,
                  MonitorCaseFile& out) {
  const auto n = static_cast<Eigen::Index>(records.size());
  const auto count = static_cast<Eigen::Index>(tracker.modes().size());
  out.tests->modes = tracker.modes();
  out.tests->probability.resize(n, count);
  out.features = Eigen::MatrixXd::Constant(n, count, kNaN);
  auto& series = out.series;
  series.features = series.sds = out.features;
  bool every_sd = true;
  const auto tracked = tracker.track(records, series.covariates);
  for (Eigen::Index t = 0; t < n; ++t) {
    const auto& one = tracked[index(t)];
    out.tests->probability.row(t) = one.probability.transpose();
    for (Eigen::Index k = 0; k < count; ++k) {
      const int mode = one.mode[index(k)];
      if (mode < 0) continue;
      const auto& identified = records[index(t)][index(mode)];
      out.features(t, k) = identified.frequency_hz;
      series.features(t, k) = std::log(identified.frequency_hz);
      series.sds(t, k) = identified.frequency_sd / identified.frequency_hz;
      every_sd = every_sd && identified.frequency_sd > 0.0;
    }
  }
  if (!every_sd) series.sds.resize(0, 0);
  for (Eigen::Index k = 0; k < count; ++k)
    series.feature_names.push_back("f" + std::to_string(k + 1) + " [Hz]");
}

void read_series_of_tests(const SeriesColumns& columns, const ModesReading& reading,
                          MonitorCaseFile& out) {
  using identification::monitoring::ModeTracker;
  const Json& series = out.file.json.at("series");
  std::vector<MonitoredTest> tests = series.contains("modes")
                                         ? read_modes_of_tests(out.file, reading)
                                         : identify_tests(out.file, reading);
  out.tests.emplace();
  if (series.contains("times")) {
    order_by_times(columns, reading, out, tests);
  } else {
    out.time = {.hours_per_unit = 1.0, .unit = "row"};
    for (std::size_t i = 0; i < tests.size(); ++i)
      out.series.hours.push_back(static_cast<double>(i + 1));
    out.series.covariates.resize(static_cast<Eigen::Index>(tests.size()), 0);
  }
  for (const MonitoredTest& test : tests) {
    out.tests->names.push_back(test.name);
    out.tests->checksums.push_back(test.checksum);
    if (!test.fault.empty())
      out.warnings.push_back("No modes were identified in " + io::printable(test.name) + ": " +
                             test.fault + ". The features of this test are missing.");
    else if (test.modes.frequencies_hz.size() == 0)
      out.warnings.push_back("No modes were identified in " + io::printable(test.name) +
                             ". The features of this test are missing.");
  }
  read_learning(out);
  const auto records = identified_records(tests);
  const auto learning = index(out.learning_rows);
  try {
    const ModeTracker tracker({records.begin(), records.begin() + out.learning_rows},
                              out.series.covariates.topRows(out.learning_rows));
    fill_tracked(tracker, records, out);
  } catch (const std::invalid_argument& error) {
    out.file.refuse(
        kSeries / (series.contains("modes") ? "modes" : "records"),
        std::string(error.what()) + " (" + std::to_string(learning) + " training records)");
  }
}

}  // namespace

Pointer source_of(const CaseFile& file) {
  for (const Pointer& where : {kSeries / "modes", kSeries / "records" / "files"})
    if (file.json.contains(where)) return where;
  return kSeries / "file";
}

std::string files_now(const CaseFile& file) {
  std::string out;
  try {
    std::vector<std::string> names;
    const Json& source = file.json.at(source_of(file));
    for (const Json& one : source.is_array() ? source : Json::array({source}))
      names.push_back(one.get<std::string>());
    std::vector<std::filesystem::path> paths = listed_files(file, source_of(file), names);
    if (file.json.contains(kSeries / "times"))
      paths.push_back(file.place_of(file.json.at(kSeries / "times").get<std::string>()));
    for (const auto& path : paths)
      out += path.string() + " " + std::to_string(std::filesystem::file_size(path)) + " " +
             std::to_string(std::filesystem::last_write_time(path).time_since_epoch().count()) +
             "\n";
  } catch (const std::exception&) {
    return {};  // the next reading reports the fault
  }
  return out;
}

Report TimeAxis::written(double hours) const {
  if (start_nanoseconds) return text(hours);
  // Times are often whole numbers in their unit: round the product to 12 digits.
  return std::stod(base::significant(hours / hours_per_unit, 12));
}

std::string TimeAxis::text(double hours) const {
  if (!start_nanoseconds) return base::significant(hours / hours_per_unit, 12);
  io::TimeStamp stamp{.nanoseconds =
                          *start_nanoseconds + std::llround(hours * 3600.0) * 1'000'000'000};
  return io::text_of(stamp);
}

MonitorCaseFile parse_monitor_case(CaseFile file, const ModesReading& reading) {
  validate_against_schema(file, "monitor");
  MonitorCaseFile out{.file = std::move(file), .title = {}};
  out.title = out.file.json.value("title", std::string("Monitoring"));
  check_source(out.file);
  const SeriesColumns columns = columns_of(out.file);
  check_uses(out.file, columns);
  if (out.file.json.at("series").contains("features"))
    read_series_table(columns, reading, out);
  else
    read_series_of_tests(columns, reading, out);
  check_series(columns, out);
  warn_of_error_codes(out);
  warn_of_dead_columns(out);
  read_alarm(out);
  out.structure = parse_monitored_structure(out.file, index(out.series.feature_count()));
  return out;
}

}  // namespace wheeltap::apps
