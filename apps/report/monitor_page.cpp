#include "apps/report/monitor_page.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/report/explained_page.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/results/monitoring/monitor_summary.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kIntervals = 700;

using Numbers = std::vector<double>;

/// Columns of series.csv: those of one feature, and those common to all features.
struct SeriesTable {
  Numbers time;
  std::vector<std::string> names;
  std::vector<Numbers> measured, predicted, sd, corrected;
  Numbers statistic, changed;
};

SeriesTable table_of(const io::Columns& series) {
  if (series.columns.size() < 8 || (series.columns.size() - 4) % 4 != 0)
    throw std::invalid_argument("series.csv does not have the columns that a run writes");
  SeriesTable out;
  const auto at = [&](std::size_t i) { return series.columns[i].values; };
  out.time = at(0);
  // Dates are in seconds since the first date.
  if (series.columns[0].cells == io::CellKind::stamp)
    for (double& t : out.time) t /= 86400.0;
  const std::size_t features = (series.columns.size() - 4) / 4;
  for (std::size_t j = 0; j < features; ++j) {
    out.names.push_back(series.columns[1 + 4 * j].header);
    out.measured.push_back(at(1 + 4 * j));
    out.predicted.push_back(at(2 + 4 * j));
    out.sd.push_back(at(3 + 4 * j));
    out.corrected.push_back(at(4 + 4 * j));
  }
  out.statistic = at(1 + 4 * features);
  out.changed = at(2 + 4 * features);
  return out;
}

/// The smallest and the largest finite value of each interval of rows, as points of two polylines.
struct Envelope {
  Numbers time, low, high;
};

Envelope envelope(const Numbers& time, const Numbers& values) {
  Envelope out;
  const std::size_t width = std::max<std::size_t>(1, (time.size() + kIntervals - 1) / kIntervals);
  for (std::size_t from = 0; from < time.size(); from += width) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = from; i < std::min(from + width, time.size()); ++i) {
      if (!std::isfinite(values[i])) continue;
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    if (!std::isfinite(low)) continue;
    out.time.push_back(time[from]);
    out.low.push_back(low);
    out.high.push_back(high);
  }
  return out;
}

/// Robust limits of an axis: the range without the outermost 0.2 % of the values.
std::pair<double, double> limits(const std::vector<const Numbers*>& lists) {
  Numbers all;
  for (const Numbers* list : lists)
    for (const double x : *list)
      if (std::isfinite(x)) all.push_back(x);
  if (all.empty()) return {0.0, 1.0};
  std::ranges::sort(all);
  const std::size_t cut = all.size() / 500;
  const double low = all[cut], high = all[all.size() - 1 - cut], pad = 0.05 * (high - low);
  return {low - pad, high + pad};
}

std::string path(const Plot& plot, const Numbers& time, const Numbers& values, double low,
                 double high) {
  std::string out;
  for (std::size_t i = 0; i < time.size(); ++i)
    out += (out.empty() ? "M" : "L") + fixed(plot.x(time[i]), 1) + " " +
           fixed(plot.y(std::clamp(values[i], low, high)), 1);
  return out;
}

/// An envelope as vertical strokes; a stroke is a point if its interval has one row.
std::string strokes(const Plot& plot, const Envelope& e, const std::string& kind, double low,
                    double high) {
  std::string d;
  for (std::size_t i = 0; i < e.time.size(); ++i) {
    const double x = plot.x(e.time[i]);
    const double top = plot.y(std::clamp(e.high[i], low, high));
    const double bottom = std::max(plot.y(std::clamp(e.low[i], low, high)), top + 1.2);
    d += "M" + fixed(x, 1) + " " + fixed(top, 1) + "V" + fixed(bottom, 1);
  }
  return "<path class=\"" + kind + "\" d=\"" + d + "\"/>\n";
}

std::string line_of(const Plot& plot, const Numbers& time, const Numbers& values,
                    const std::string& kind, double low, double high) {
  return "<path class=\"" + kind + "\" d=\"" + path(plot, time, values, low, high) + "\"/>\n";
}

std::string feature_charts(const SeriesTable& t, std::size_t j, const std::string& unit,
                           const std::vector<double>& marks) {
  Numbers lower(t.time.size()), upper(t.time.size());
  for (std::size_t i = 0; i < t.time.size(); ++i) {
    lower[i] = t.predicted[j][i] - 1.96 * t.sd[j][i];
    upper[i] = t.predicted[j][i] + 1.96 * t.sd[j][i];
  }
  const auto [low, high] = limits({&t.measured[j], &t.predicted[j]});
  const Plot plot(t.time.front(), t.time.back(), low, high, 240.0);
  const Envelope bottom = envelope(t.time, lower), top = envelope(t.time, upper);
  std::string inside = strokes(plot, envelope(t.time, t.measured[j]), "spectrum", low, high) +
                       line_of(plot, bottom.time, bottom.low, "line", low, high) +
                       line_of(plot, top.time, top.high, "line", low, high) + plot.hairs(marks);
  std::string out =
      "<h3>" + escaped(t.names[j]) + "</h3>\n<div class=\"pair\"><div>" +
      plot.framed("measured values of " + t.names[j] + " with the 95 % prediction interval", unit,
                  t.names[j], inside) +
      "</div>\n<div>";
  const auto [least, most] = limits({&t.corrected[j]});
  const Plot other(t.time.front(), t.time.back(), least, most, 240.0);
  out += other.framed(t.names[j] + " corrected for weather", unit, t.names[j] + ", corrected",
                      strokes(other, envelope(t.time, t.corrected[j]), "spectrum", least, most) +
                          other.hairs(marks));
  return out + "</div></div>\n";
}

std::string single_chart(const Numbers& time, const Numbers& values, const std::string& label,
                         const std::string& unit, double low, double high,
                         const std::vector<double>& marks, double threshold) {
  const Plot plot(time.front(), time.back(), low, high, 220.0);
  const Envelope e = envelope(time, values);
  std::string inside = line_of(plot, e.time, e.high, "line", low, high) + plot.hairs(marks);
  if (std::isfinite(threshold))
    inside += "<path class=\"doubt\" d=\"M" + fixed(plot.x(time.front()), 1) + " " +
              fixed(plot.y(threshold), 1) + "H" + fixed(plot.x(time.back()), 1) + "\"/>\n";
  return plot.framed(label, unit, label, inside);
}

std::string time_text(const Report& t) {
  return t.is_string() ? t.get<std::string>() : base::significant(t.get<double>(), 8);
}

/// Table of the alarms. `days` holds the time of each alarm on the axis of the figures, for dates.
std::string alarm_log(const Report& alarms, const Numbers& days) {
  if (alarms.empty()) return "<p>No alarm.</p>\n";
  std::string out =
      "<div class=\"scroll\"><table><tr><th>alarm</th><th>onset, median</th>"
      "<th>95 % interval</th><th>P(changed)</th><th>shifts</th></tr>\n";
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    const Report& a = alarms[i];
    out += "<tr><td>" + escaped(time_text(a.at("time"))) +
           (i < days.size() ? " (day " + fixed(days[i], 1) + ")" : std::string()) + "</td><td>" +
           escaped(time_text(a.at("onset").at("q50"))) + "</td><td>" +
           escaped(time_text(a.at("onset").at("q2.5"))) + " to " +
           escaped(time_text(a.at("onset").at("q97.5"))) + "</td><td>" +
           percent(a.at("probability_changed").get<double>()) + "</td><td class=\"odd\">" +
           escaped(shifts_in_words(a)) + "</td></tr>\n";
  }
  return out + "</table></div>\n";
}

std::string tracked_table(const Report& modes) {
  std::string out =
      "<h2 id=\"tracked\">Tracked modes</h2>\n<div class=\"scroll\"><table><tr><th>mode</th>"
      "<th>median in the training period [Hz]</th><th>standard deviation about the prediction</th>"
      "<th>identified</th><th>missing</th>"
      "<th>mean probability of the assignment</th></tr>\n";
  for (const Report& m : modes)
    out += "<tr><td>" + escaped(m.at("name").get<std::string>()) + "</td><td>" +
           significant(m.at("frequency_hz").get<double>(), 6) + "</td><td>" +
           fixed(100.0 * m.at("scatter").get<double>(), 2) + " %</td><td>" +
           std::to_string(m.at("identified").get<long>()) + "</td><td>" +
           std::to_string(m.at("missing").get<long>()) + "</td><td>" +
           percent(m.at("mean_probability").get<double>()) + "</td></tr>\n";
  return out + "</table></div>\n";
}

/// An entry as text; "–" if it is null or absent.
std::string entry_or_dash(const Report& of, const char* key) {
  if (!of.contains(key) || of.at(key).is_null()) return "–";
  const Report& x = of.at(key);
  return x.is_string() ? x.get<std::string>() : base::significant(x.get<double>(), 6);
}

std::string chart_section(const Report& monitor, const io::Columns& charts, const std::string& unit,
                          const std::vector<double>& marks) {
  std::string out =
      "<h2 id=\"charts\">Comparison charts</h2>\n<p>Control charts trained on the same "
      "rows. "
      "Each threshold is calibrated for the stated rate of false alarms. A delay is measured from "
      "the median onset of the first alarm in the table above.</p>\n<div "
      "class=\"scroll\"><table><tr><th>chart</th><th>first "
      "alarm"
      "</th><th>alarms</th><th>alarms before the onset</th><th>delay</th></tr>\n";
  for (const Report& chart : monitor.at("charts"))
    out += "<tr><td>" + escaped(chart.at("name").get<std::string>()) + "</td><td>" +
           escaped(entry_or_dash(chart, "first_alarm")) + "</td><td>" +
           entry_or_dash(chart, "alarms") + "</td><td>" +
           entry_or_dash(chart, "alarms_before_onset") + "</td><td>" +
           entry_or_dash(chart, "delay") + "</td></tr>\n";
  out += "</table></div>\n";
  Numbers time = charts.columns[0].values;
  if (charts.columns[0].cells == io::CellKind::stamp)
    for (double& t : time) t /= 86400.0;
  for (std::size_t c = 1; c < charts.columns.size(); ++c) {
    Numbers ratio = charts.columns[c].values;
    for (double& x : ratio) x = x > 0.0 ? std::log10(x) : NAN;
    const auto [low, high] = limits({&ratio});
    out += "<h3>" + escaped(charts.columns[c].header) + "</h3>\n" +
           single_chart(time, ratio, "log10(statistic / threshold)", unit, std::max(low, -3.0),
                        std::max(high, 0.5), marks, 0.0);
  }
  return out;
}

}  // namespace

std::string monitor_page(const Report& summary, const io::Columns& series,
                         const std::optional<io::Columns>& charts) {
  const SeriesTable t = table_of(series);
  if (t.time.empty()) throw std::invalid_argument("series.csv has no rows");
  const Report& monitor = summary.at("monitor");
  const bool dates = series.columns[0].cells == io::CellKind::stamp;
  std::vector<std::string> details;
  for (const Report& a : monitor.at("alarms"))
    details.push_back("Shifts at the alarm of " + time_text(a.at("time")) + ": " +
                      shifts_in_words(a) + ".");
  details.push_back(false_alarms_in_words(monitor));
  std::string out =
      page_head(summary.at("title").get<std::string>(), monitor_headline(monitor), details);
  const std::string first = series.layout ? series.layout->start : "the first row";
  const std::string unit =
      dates ? "days since " + first : "time [" + monitor.value("time_unit", std::string("h")) + "]";
  std::vector<double> marks;
  const io::Column& alarm = series.columns.back();
  for (std::size_t i = 0; i < t.time.size(); ++i)
    if (alarm.values[i] > 0.5) marks.push_back(t.time[i]);
  const Report& warnings = summary.at("diagnostics").at("warnings");
  if (!warnings.empty()) out += "<h2 id=\"warnings\">Warnings</h2>\n";
  for (const Report& w : warnings)
    out += "<p class=\"odd\">" + escaped(w.get<std::string>()) + "</p>\n";
  out += "<h2>Alarms</h2>\n" + alarm_log(monitor.at("alarms"), dates ? marks : Numbers());
  out += explanation_section(monitor);
  out += "<h2>Probability of a change</h2>\n" +
         single_chart(t.time, t.changed, "P(changed)", unit, 0.0, 1.0, marks, NAN);
  const double threshold = monitor.at("log_threshold").at("used").get<double>();
  const auto [low, high] = limits({&t.statistic});
  out += "<h2>Alarm statistic</h2>\n" +
         single_chart(t.time, t.statistic, "ln S", unit, std::min(low, 0.0),
                      std::max(high, threshold + 1.0), marks, threshold) +
         "<p>The Shiryaev-Roberts statistic and its threshold. Dashed lines mark alarms. Some rows "
         "after an alarm, the change is accepted: the statistic restarts, and P(changed) still "
         "includes the accepted "
         "change.</p>\n";
  if (monitor.contains("tracked_modes")) out += tracked_table(monitor.at("tracked_modes"));
  out +=
      "<h2>Features</h2>\n<p>Grey: measured values. Lines: 95 % prediction interval without "
      "a change since the last alarm. The interval is wide in rows without covariates. Second "
      "figure "
      "of each feature: the values without the effect of the covariates.</p>\n";
  for (std::size_t j = 0; j < t.names.size(); ++j) out += feature_charts(t, j, unit, marks);
  if (charts) out += chart_section(monitor, *charts, unit, marks);
  return out + page_end();
}

}  // namespace wheeltap::apps
