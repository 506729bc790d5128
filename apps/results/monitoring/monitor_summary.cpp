#include "apps/results/monitoring/monitor_summary.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "apps/cases/monitoring/csv_header.hpp"
#include "apps/results/monitoring/explained_change.hpp"
#include "apps/results/terminal.hpp"
#include "apps/words.hpp"
#include "base/index.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

using identification::monitoring::AlarmRecord;
using identification::monitoring::ChangeEstimate;
using identification::monitoring::Monitor;
using identification::monitoring::RowFinding;

std::string cell(double x) {
  return std::isfinite(x) ? base::significant(x, 9) : std::string();
}

Report change_json(const MonitorCaseFile& parsed, const ChangeEstimate& change) {
  Report features = Report::array();
  for (Eigen::Index j = 0; j < change.shift.size(); ++j)
    features.push_back({{"name", parsed.series.feature_names[index(j)]},
                        {"shift", change.shift[j]},
                        {"sd", change.shift_sd[j]},
                        {"probability_shifted", change.shifted_probability[j]}});
  return {{"onset",
           {{"q2.5", parsed.time.written(change.onset_low)},
            {"q50", parsed.time.written(change.onset_median)},
            {"q97.5", parsed.time.written(change.onset_high)}}},
          {"probability_changed", change.probability},
          {"probability_ramp", change.ramp_probability},
          {"features", features}};
}

Report alarm_json(const MonitorCaseFile& parsed, const AlarmRecord& alarm) {
  Report out = change_json(parsed, alarm.change);
  out["time"] = parsed.time.written(alarm.hours);
  out["probability_at_alarm"] = alarm.probability_at_alarm;
  if (parsed.tests) {
    const auto& hours = parsed.series.hours;
    const auto row = std::ranges::lower_bound(hours, alarm.hours) - hours.begin();
    out["file"] =
        parsed.tests->names[index(std::min<std::ptrdiff_t>(row, parsed.series.rows() - 1))];
  }
  return out;
}

/// Tracked modes: fraction of tests with the mode, and probability of its assignments.
Report tracked_json(const MonitorCaseFile& parsed) {
  Report out = Report::array();
  for (std::size_t k = 0; k < parsed.tests->modes.size(); ++k) {
    const auto& mode = parsed.tests->modes[k];
    const auto column = static_cast<Eigen::Index>(k);
    long present = 0;
    double probability = 0.0;
    for (Eigen::Index t = 0; t < parsed.features.rows(); ++t)
      if (std::isfinite(parsed.features(t, column))) {
        ++present;
        probability += parsed.tests->probability(t, column);
      }
    out.push_back(
        {{"name", parsed.series.feature_names[k]},
         {"frequency_hz", std::exp(mode.log_frequency)},
         {"scatter", mode.scatter},
         {"identified", present},
         {"missing", parsed.features.rows() - present},
         {"mean_probability", present > 0 ? probability / static_cast<double>(present) : 0.0}});
  }
  return out;
}

Report baseline_json(const Monitor& monitor) {
  const auto& baseline = monitor.baseline();
  Report hinges = Report::object();
  for (std::size_t k = 0; k < baseline.hinge_probability.size(); ++k)
    hinges[std::to_string(k)] = baseline.hinge_probability[k];
  Report draws = Report::array();
  for (const auto& draw : baseline.draws) {
    const auto& p = draw.parameters;
    Report knots = Report::array();
    for (std::size_t h = 0; h < p.terms.knots.size(); ++h) {
      const int c = p.terms.hinge_of[h];
      knots.push_back(
          {{"covariate", baseline.scaling.used()[index(c)]},
           {"at", baseline.scaling.mean(c) + baseline.scaling.sd(c) * p.terms.knots[h]}});
    }
    draws.push_back(
        {{"lag_hours", p.terms.lag_hours},
         {"drift_hours", 1.0 / p.fast_rate},
         {"degrees_of_freedom", std::isfinite(p.degrees) ? Report(p.degrees) : Report("gaussian")},
         {"hinges", knots}});
  }
  return {{"hinges", hinges},
          {"residual_sd",
           std::vector<double>(baseline.residual_sd.begin(), baseline.residual_sd.end())},
          {"draws", draws},
          {"rhat_max", finite(baseline.rhat_max)}};
}

/// Number of monitored rows with at least one feature.
long rows_with_features(const MonitorCaseFile& parsed) {
  long out = 0;
  for (Eigen::Index i = parsed.learning_rows; i < parsed.features.rows(); ++i)
    out += parsed.features.row(i).array().isFinite().any() ? 1 : 0;
  return out;
}

/// A probability after "P(changed)": "= 12.3 %" or "> 99.9 %".
std::string related(double probability) {
  const std::string text = percent(probability);
  return (text.starts_with('<') || text.starts_with('>') ? "" : "= ") + text;
}

/// Writes times of a monitored series with their unit.
struct TimeWords {
  explicit TimeWords(const Report& monitor) {
    const std::string unit = monitor.value("time_unit", std::string());
    before = unit == "row" ? "row " : "";
    after = unit == "row" || unit == "date" || unit.empty() ? "" : " " + unit;
  }
  [[nodiscard]] static std::string plain(const Report& t) {
    return t.is_string() ? t.get<std::string>() : base::significant(t.get<double>(), 8);
  }
  [[nodiscard]] std::string at(const Report& t) const { return before + plain(t) + after; }
  [[nodiscard]] std::string onset(const Report& onset) const {
    return at(onset.at("q50")) + " (95 % interval " + plain(onset.at("q2.5")) + " to " +
           plain(onset.at("q97.5")) + after + ")";
  }

  std::string before, after;
};

std::string headline_without_alarm(const Report& monitor) {
  const long rows = monitor.at("rows").get<long>() - monitor.at("learning_rows").get<long>();
  if (monitor.at("rows_with_features").get<long>() == 0)
    return "No alarm: none of the " + base::grouped(rows) +
           " monitored rows has a value of a feature.";
  const std::string none = "No alarm in " + base::grouped(rows) + " monitored rows";
  const std::string changed =
      "P(changed) " + related(monitor.at("probability_changed").get<double>());
  if (!monitor.contains("possible_change") || monitor.at("log_statistic").is_null())
    return none + "; " + changed + ".";
  const Report& change = monitor.at("possible_change");
  return none + ": the alarm statistic, ln S = " +
         base::fixed(monitor.at("log_statistic").get<double>(), 1) + ", is below its threshold, " +
         base::fixed(monitor.at("log_threshold").at("used").get<double>(), 1) +
         ". A change is nevertheless probable: " + changed + ", onset " +
         TimeWords(monitor).onset(change.at("onset")) + ", " + shifts_in_words(change) + ".";
}

}  // namespace

std::string series_header(const MonitorCaseFile& parsed) {
  std::string out = "time";
  for (const std::string& name : parsed.series.feature_names)
    for (const char* what : {"", " predicted", " sd", " corrected"})
      out += "," + csv_header(name + what);
  return out + ",log statistic,P(changed),alarm\n";
}

std::string series_row(const MonitorCaseFile& parsed, int i, const RowFinding& row) {
  std::string out = parsed.time.text(row.hours);
  for (Eigen::Index j = 0; j < row.predicted.mean.size(); ++j) {
    const double predicted = std::exp(row.predicted.mean[j]);
    out += "," + cell(parsed.features(i, j)) + "," + cell(predicted) + "," +
           cell(predicted * row.predicted.sd[j]) + "," + cell(std::exp(row.corrected[j]));
  }
  const bool learning = i < parsed.learning_rows;
  out += "," + (learning ? std::string() : cell(row.log_statistic));
  out += "," + (learning ? std::string() : cell(row.probability_changed));
  return out + (row.alarm ? ",1\n" : ",0\n");
}

Report monitor_summary(const MonitorCaseFile& parsed, const Monitor& monitor, const RunInfo& info) {
  Report alarms = Report::array();
  for (const AlarmRecord& alarm : monitor.alarms()) alarms.push_back(alarm_json(parsed, alarm));
  const double per_year = monitor.rows_per_year();
  Report rates = {{"stated", per_year * std::exp(-monitor.log_threshold_stated())},
                  {"replayed", per_year * monitor.replay().rate(monitor.log_threshold_stated())}};
  Report result = {
      {"alarm", !monitor.alarms().empty()},
      {"first_alarm", alarms.empty() ? Report() : alarms[0]["time"]},
      {"alarms", alarms},
      {"probability_changed", monitor.probability_changed()},
      {"log_statistic", finite(monitor.change().log_statistic())},
      {"false_alarms_per_year", rates},
      {"replayed_is_lower_bound", monitor.replay().is_lower_bound(monitor.log_threshold_stated())},
      {"log_threshold",
       {{"stated", monitor.log_threshold_stated()},
        {"replayed", monitor.log_threshold_replayed()},
        {"used", monitor.log_threshold()}}},
      {"rows", parsed.series.rows()},
      {"time_unit", parsed.time.unit},
      {"learning_rows", parsed.learning_rows},
      {"rows_with_features", rows_with_features(parsed)},
      {"unscored_rows", monitor.unscored_rows()},
      {"last_time", parsed.time.written(parsed.series.hours.back())},
      {"onset_mass_moved", monitor.change().moved_mass()},
      {"baseline", baseline_json(monitor)}};
  if (parsed.tests) result["tracked_modes"] = tracked_json(parsed);
  if (parsed.time.unit == "row") {
    result["rows_between_false_alarms"] = {
        {"stated", std::exp(monitor.log_threshold_stated())},
        {"replayed", 1.0 / monitor.replay().rate(monitor.log_threshold_stated())}};
  }
  if (monitor.alarms().empty() && monitor.probability_changed() > 0.5)
    result["possible_change"] = change_json(parsed, monitor.change().estimate());
  std::vector<std::string> warnings = parsed.warnings;
  const long monitored = rows_with_features(parsed);
  if (monitor.unscored_rows() > 0)
    warnings.push_back("The features of " + base::grouped(monitor.unscored_rows()) + " of " +
                       base::grouped(monitored) +
                       " monitored rows were not used, because covariates of these rows or of "
                       "the preceding rows are missing. No alarm is possible in these rows.");
  if (!(monitor.baseline().rhat_max < 1.1))
    warnings.push_back(
        "The chains of the training period have not converged (R-hat " +
        significant(monitor.baseline().rhat_max, 3) +
        "): prediction bands and alarm times may differ for another seed. Run again with another "
        "seed, without --resume, and compare; a longer training period helps.");
  Report out = {{"wheeltap", about("monitor", info, parsed.file)}};
  out["title"] = parsed.title;
  out["answer"] = {monitor_headline(result)};
  out["monitor"] = std::move(result);
  out["diagnostics"] = {{"warnings", warnings}};
  return out;
}

std::string monitor_headline(const Report& monitor) {
  if (!monitor.at("alarm").get<bool>()) return headline_without_alarm(monitor);
  const Report& alarms = monitor.at("alarms");
  const Report& last = alarms.back();
  const TimeWords words(monitor);
  const double now = last.at("probability_changed").get<double>();
  std::string out =
      (alarms.size() == 1 ? "Alarm at " : std::to_string(alarms.size()) + " alarms, the last at ") +
      words.at(last.at("time")) + ": features changed at " + words.onset(last.at("onset")) + ", ";
  if (now < 0.5)
    return out + "probability " + percent(last.at("probability_at_alarm").get<double>()) +
           " at the alarm, but " + percent(now) +
           " after further rows: the shift was probably temporary.";
  return out + "probability " + percent(now) + ".";
}

std::string shifts_in_words(const Report& alarm) {
  std::vector<std::pair<double, std::string>> shifts;
  for (const Report& f : alarm.at("features")) {
    const double shift = f.at("shift").get<double>(), sd = f.at("sd").get<double>();
    // "probability_shifted" compares shifts of all features with a shift of one feature. If several
    // features shifted, only shifts whose 95 % interval excludes zero are reported.
    if (f.at("probability_shifted").get<double>() < 0.5 || std::abs(shift) < 1.96 * sd) continue;
    shifts.emplace_back(-std::abs(shift) / std::max(sd, 1e-300),
                        f.at("name").get<std::string>() + " by " +
                            base::fixed(100.0 * std::expm1(shift), 2) + " % (sd " +
                            base::fixed(100.0 * sd, 2) + " %)");
  }
  std::ranges::sort(shifts);
  std::vector<std::string> words;
  for (const auto& [order, text] : shifts) words.push_back(text);
  return words.empty() ? std::string("no feature whose shift differs significantly from zero")
                       : in_words(words);
}

std::string false_alarms_in_words(const Report& monitor) {
  const bool rows = monitor.contains("rows_between_false_alarms");
  const Report& rates = monitor.at(rows ? "rows_between_false_alarms" : "false_alarms_per_year");
  const Report& thresholds = monitor.at("log_threshold");
  const double model = thresholds.at("stated").get<double>();
  const double used = thresholds.at("used").get<double>();
  const auto rate = [&](const char* which) {
    const std::string number = significant(rates.at(which).get<double>(), 3);
    return rows ? "one in " + number + " rows" : number + " a year";
  };
  const bool bound = monitor.at("replayed_is_lower_bound").get<bool>();
  const std::string replayed =
      (bound ? rows ? "more than " : "at least " : std::string()) + rate("replayed");
  if (used > model)
    return "False alarms at the threshold in use, ln S = " + base::fixed(used, 1) + ": " +
           rate("stated") +
           ", as specified, from replayed healthy rows. At the threshold of the model, " +
           base::fixed(model, 1) + ", the replay gives " + replayed + ".";
  return "False alarms at the threshold of the model, ln S = " + base::fixed(model, 1) + ": " +
         rate("stated") + ", as specified. Replayed healthy rows give " + replayed + ".";
}

void print_monitor(std::ostream& out, const MonitorCaseFile& parsed, const Report& summary,
                   bool colour) {
  const Page page{out, colour};
  const Report& monitor = summary.at("monitor");
  out << page.bold(io::printable(parsed.title)) << "\n\n";
  page.wrapped(monitor_headline(monitor), "", "");
  for (const Report& alarm : monitor.at("alarms")) {
    page.wrapped("Shifts: " + io::printable(shifts_in_words(alarm)) + ".", "  ", "  ");
    for (const std::string& text : explanation_in_words(alarm))
      page.wrapped(io::printable(text), "  ", "  ");
  }
  page.wrapped(false_alarms_in_words(monitor), "", "");
  for (const Report& text : summary.at("diagnostics").at("warnings"))
    page.wrapped(io::printable(text.get<std::string>()), "! ", "  ");
}

}  // namespace wheeltap::apps
