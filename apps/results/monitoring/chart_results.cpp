#include "apps/results/monitoring/chart_results.hpp"

#include <cmath>

#include "base/index.hpp"
#include "base/number.hpp"

namespace wheeltap::apps {

using identification::monitoring::ChartFinding;
using identification::monitoring::Monitor;

std::string charts_csv(const MonitorCaseFile& parsed, const std::vector<ChartFinding>& charts) {
  std::string out = "time";
  for (const ChartFinding& chart : charts) out += "," + chart.name;
  out += "\n";
  for (int i = parsed.learning_rows; i < parsed.series.rows(); ++i) {
    out += parsed.time.text(parsed.series.hours[index(i)]);
    for (const ChartFinding& chart : charts) {
      const double s = chart.statistic[index(i - parsed.learning_rows)] / chart.threshold;
      out += "," + (std::isfinite(s) ? base::significant(s, 6) : std::string());
    }
    out += "\n";
  }
  return out;
}

Report charts_json(const MonitorCaseFile& parsed, const Monitor& monitor,
                   const std::vector<ChartFinding>& charts) {
  Report out = Report::array();
  const auto& hours = parsed.series.hours;
  for (const ChartFinding& chart : charts) {
    Report one = {
        {"name", chart.name},
        {"threshold", chart.threshold},
        {"alarms", chart.alarms.size()},
        {"first_alarm",
         chart.alarms.empty() ? Report() : parsed.time.written(hours[index(chart.alarms[0])])}};
    if (!monitor.alarms().empty()) {
      const auto& onset = monitor.alarms().front().change;
      int before = 0;
      Report delay;
      for (const int row : chart.alarms) {
        const double at = hours[index(row)];
        if (at < onset.onset_low)
          ++before;
        else if (delay.is_null())
          delay = (at - onset.onset_median) /
                  (parsed.time.start_nanoseconds ? 1.0 : parsed.time.hours_per_unit);
      }
      one["alarms_before_onset"] = before;
      one["delay"] = delay;
    }
    out.push_back(one);
  }
  return out;
}

}  // namespace wheeltap::apps
