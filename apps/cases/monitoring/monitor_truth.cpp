#include "apps/cases/monitoring/monitor_truth.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/monitoring/csv_header.hpp"
#include "apps/cases/monitoring/monitored_structure.hpp"
#include "apps/explained.hpp"
#include "apps/nearest.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "identification/monitoring/series_simulation.hpp"
#include "io/text/time_stamp.hpp"

namespace wheeltap::apps {
namespace {

using Eigen::Index;
using identification::monitoring::ChangeTruth;
using identification::monitoring::SeriesTruth;

const Pointer kTruth("/truth");

class TruthParser {
 public:
  explicit TruthParser(const CaseFile& file)
      : file_(file), features_(names("features")), covariates_(names("covariates")) {
    structure_ = parse_monitored_structure(file, features_.size());
  }

  [[nodiscard]] const std::vector<std::string>& features() const { return features_; }
  [[nodiscard]] const std::vector<std::string>& covariates() const { return covariates_; }

  SeriesTruth parse() {
    SeriesTruth out;
    const Json& t = file_.json.at(kTruth);
    out.rows = t.value("rows", out.rows);
    out.interval_hours = t.value("interval_hours", out.interval_hours);
    parse_weather(out);
    parse_features(out);
    out.lag_hours = t.value("lag_hours", out.lag_hours);
    const Json frost = t.value("frost", Json::object());
    out.freezing = frost.value("below", out.freezing);
    out.gradual_frost = frost.value("gradual", false);
    const Json drift = t.value("drift", Json::object());
    out.drift_hours = drift.value("hours", out.drift_hours);
    out.drift_correlation = drift.value("correlation", out.drift_correlation);
    const Json unmeasured = t.value("unmeasured", Json::object());
    out.unmeasured_hours = unmeasured.value("hours", out.unmeasured_hours);
    out.noise_degrees = t.value("noise_degrees", out.noise_degrees);
    const Json outliers = t.value("outliers", Json::object());
    out.outlier_share = outliers.value("share", out.outlier_share);
    out.outlier_factor = outliers.value("factor", out.outlier_factor);
    out.missing_share = t.value("missing", out.missing_share);
    const std::vector<double> lags = one_each(kTruth / "thermometer_lag_hours", covariates_, 0.0);
    const std::vector<double> noise = one_each(kTruth / "thermometer_noise", covariates_, 0.1);
    for (std::size_t i = 0; i < covariates_.size(); ++i)
      out.thermometers.push_back({.lag_hours = lags[i], .noise_sd = noise[i]});
    if (t.contains("changes"))
      for (std::size_t i = 0; i < t["changes"].size(); ++i)
        out.changes.push_back(change(kTruth / "changes" / i));
    return out;
  }

 private:
  std::vector<std::string> names(const char* key) const {
    std::vector<std::string> out;
    const Json& series = file_.json.at("series");
    if (!series.contains(key)) return out;
    for (std::size_t i = 0; i < series[key].size(); ++i) {
      if (!series[key][i].is_string())
        file_.refuse(
            Pointer("/series") / key / i,
            "must be a column header: a simulated table has the columns that the case names");
      out.push_back(series[key][i].get<std::string>());
    }
    return out;
  }

  /// Parses a number for all columns, or a list with one number per column.
  std::vector<double> one_each(const Pointer& where, const std::vector<std::string>& columns,
                               double otherwise) const {
    if (!file_.json.contains(where)) return std::vector<double>(columns.size(), otherwise);
    const Json& value = file_.json.at(where);
    if (value.is_number()) return std::vector<double>(columns.size(), value.get<double>());
    if (value.size() != columns.size())
      file_.refuse(where, "must be a number, or a list of " + std::to_string(columns.size()) +
                              " numbers, one for each column");
    return value.get<std::vector<double>>();
  }

  void parse_weather(SeriesTruth& out) const {
    const Json w = file_.json.at(kTruth).value("weather", Json::object());
    auto& weather = out.weather;
    weather.mean = w.value("mean", weather.mean);
    weather.season = w.value("season", weather.season);
    weather.day = w.value("day", weather.day);
    weather.front_sd = w.value("front_sd", weather.front_sd);
    weather.front_hours = w.value("front_hours", weather.front_hours);
    weather.first_day = w.value("first_day", weather.first_day);
  }

  void parse_features(SeriesTruth& out) const {
    const Pointer where = kTruth / "frequencies";
    if (!file_.json.contains(where) && !structure_)
      file_.refuse(where,
                   "is missing: give one frequency in Hz for each feature, or a "
                   "\"structure\" or \"beam\" from which Wheeltap computes the frequencies");
    const std::vector<double> values =
        file_.json.contains(where) ? one_each(where, features_, 0.0) : structure_->intact_hz;
    const std::vector<double> slopes = one_each(kTruth / "per_degree", features_, -0.0005);
    const std::vector<double> frost = one_each(kTruth / "frost" / "per_degree", features_, -0.0025);
    const std::vector<double> noise = one_each(kTruth / "noise", features_, 0.003);
    const std::vector<double> drift = one_each(kTruth / "drift" / "sd", features_, 0.001);
    const std::vector<double> other = one_each(kTruth / "unmeasured" / "sd", features_, 0.0);
    for (std::size_t j = 0; j < features_.size(); ++j)
      out.features.push_back({.value = values[j],
                              .slope = slopes[j],
                              .frost = frost[j],
                              .noise_sd = noise[j],
                              .drift_sd = drift[j],
                              .unmeasured_sd = other[j]});
  }

  /// Parses an object that gives numbers for some columns by name; other columns get zero.
  Eigen::VectorXd named(const Pointer& where, const std::vector<std::string>& columns) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Index>(columns.size()));
    for (const auto& [name, value] : file_.json.at(where).items()) {
      const auto found = std::ranges::find(columns, name);
      if (found == columns.end())
        file_.refuse(where / name,
                     "there is no such column in \"series\"" + did_you_mean(name, columns));
      out[found - columns.begin()] = value.get<double>();
    }
    return out;
  }

  ChangeTruth change(const Pointer& where) const {
    const Json& c = file_.json.at(where);
    ChangeTruth out{.hours = c.at("hour").get<double>(), .ramp_hours = c.value("ramp_hours", 0.0)};
    int kinds = 0;
    for (const char* key : {"damage", "features", "covariates"}) kinds += c.contains(key) ? 1 : 0;
    if (kinds != 1)
      file_.refuse(where, "must have one of \"damage\": true, \"features\" and \"covariates\"");
    if (c.contains("features"))
      out.shift = named(where / "features", features_).array().log1p();
    else if (c.contains("covariates"))
      out.offset = named(where / "covariates", covariates_);
    else
      out.shift = shift_of_damage(where / "damage");
    return out;
  }

  Eigen::VectorXd shift_of_damage(const Pointer& where) const {
    if (!structure_)
      file_.refuse(where, "needs a \"structure\" or \"beam\", and \"truth\" in \"damage\"");
    const auto& damage = structure_->parsed.damage;
    if (std::ranges::all_of(damage.kinds, [](const auto& kind) { return kind.truth.empty(); }))
      file_.refuse(where, "\"damage\" has no \"truth\" with the defects to simulate");
    const int wanted = *std::ranges::max_element(structure_->modes) + 1;
    const auto found =
        explained(structure_->parsed, [&] { return true_frequencies(damage, wanted); });
    Eigen::VectorXd out(static_cast<Index>(features_.size()));
    for (std::size_t j = 0; j < features_.size(); ++j)
      out[static_cast<Index>(j)] =
          std::log(found[index(structure_->modes[j])] / structure_->intact_hz[j]);
    return out;
  }

  const CaseFile& file_;
  std::vector<std::string> features_, covariates_;
  std::optional<MonitoredStructure> structure_;
};

/// Writes times in the form that the case defines.
class TimeWriter {
 public:
  explicit TimeWriter(const CaseFile& file) {
    const Pointer where = kTruth / "start";
    if (file.json.contains(where)) {
      if (file.json.at("series").contains("time_unit"))
        file.refuse(where, "with this key, times are dates: remove \"time_unit\" from /series");
      const auto stamp = io::read_stamp(file.json.at(where).get<std::string>()).stamp;
      if (!stamp || !stamp->has_date)
        file.refuse(where, "must be an ISO 8601 date, for example \"2026-01-01T00:00Z\"");
      start_ = stamp->nanoseconds;
      zone_ = stamp->has_zone ? "Z" : "";
      return;
    }
    const std::string unit = file.json.at("series").value("time_unit", std::string("h"));
    per_hour_ = unit == "s" ? 3600.0 : unit == "min" ? 60.0 : unit == "d" ? 1.0 / 24.0 : 1.0;
    by_row_ = unit == "row";
  }
  [[nodiscard]] std::string text(int row, double hours) const {
    if (start_)
      return io::text_of(io::TimeStamp{.nanoseconds = *start_ + std::llround(hours * 3600.0) *
                                                                    1'000'000'000}) +
             zone_;
    return by_row_ ? std::to_string(row) : base::significant(hours * per_hour_, 12);
  }

 private:
  std::optional<std::int64_t> start_ = {};
  std::string zone_ = {};
  double per_hour_ = 1.0;
  bool by_row_ = false;
};

}  // namespace

SimulatedTable simulated_table(CaseFile file, std::optional<std::uint64_t> seed) {
  validate_against_schema(file, "monitor");
  if (!file.json.contains(kTruth))
    file.refuse(kTruth, "is missing: must be an object that describes the series to simulate");
  const Json& time = file.json.at("series").at("time");
  if (!time.is_string())
    file.refuse(Pointer("/series/time"),
                "must be a column header: a simulated table has the columns that the case names");
  TruthParser parser(file);
  const SeriesTruth truth = parser.parse();
  const TimeWriter times(file);
  SimulatedTable out{.rows = truth.rows,
                     .features = static_cast<int>(truth.features.size()),
                     .seed = seed.value_or(file.json.at(kTruth).value("seed", std::uint64_t{1}))};
  const auto series = identification::monitoring::simulate_series(truth, out.seed);
  out.csv = csv_header(time.get<std::string>());
  for (const auto* list : {&parser.features(), &parser.covariates()})
    for (const std::string& name : *list) out.csv += "," + csv_header(name);
  out.csv += "\n";
  for (Index t = 0; t < series.features.rows(); ++t) {
    out.csv += times.text(static_cast<int>(t), series.hours[index(t)]);
    for (Index j = 0; j < series.features.cols(); ++j) {
      out.csv += ",";
      if (std::isfinite(series.features(t, j)))
        out.csv += base::significant(std::exp(series.features(t, j)), 7);
    }
    for (Index i = 0; i < series.covariates.cols(); ++i)
      out.csv += "," + base::fixed(series.covariates(t, i), 3);
    out.csv += "\n";
  }
  return out;
}

}  // namespace wheeltap::apps
