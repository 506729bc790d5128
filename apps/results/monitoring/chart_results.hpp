// Results of the comparison charts: charts.csv, and their part of summary.json.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "identification/monitoring/charts/comparison_charts.hpp"

namespace wheeltap::apps {

/// "time,T² of features,…": statistics over their thresholds, of the rows after learning; cells
/// without a statistic are empty.
[[nodiscard]] std::string charts_csv(
    const MonitorCaseFile& parsed,
    const std::vector<identification::monitoring::ChartFinding>& charts);

/// A list with name, threshold, alarms and first_alarm of each chart. Where `monitor` (the
/// summary's) has an alarm also alarms_before_onset and delay: the time from the median onset of
/// its first alarm to the chart's first alarm after it, in time units (hours for dates).
[[nodiscard]] Report charts_json(
    const MonitorCaseFile& parsed, const identification::monitoring::Monitor& monitor,
    const std::vector<identification::monitoring::ChartFinding>& charts);

}  // namespace wheeltap::apps
