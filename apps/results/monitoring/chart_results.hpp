// Results of the comparison charts: charts.csv, and their part of summary.json.
#pragma once

#include <string>
#include <vector>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "identification/monitoring/charts/comparison_charts.hpp"

namespace wheeltap::apps {

/// CSV "time,T² of features,…": statistics divided by their thresholds, for the rows after the
/// training period. Cells without a statistic are empty.
[[nodiscard]] std::string charts_csv(
    const MonitorCaseFile& parsed,
    const std::vector<identification::monitoring::ChartFinding>& charts);

/// A list with name, threshold, alarms and first_alarm of each chart. If `monitor` has an alarm,
/// the list also has alarms_before_onset and delay. The delay is the time from the median onset of
/// the first alarm of `monitor` to the next alarm of the chart, in time units of the case (hours
/// for dates).
[[nodiscard]] Report charts_json(
    const MonitorCaseFile& parsed, const identification::monitoring::Monitor& monitor,
    const std::vector<identification::monitoring::ChartFinding>& charts);

}  // namespace wheeltap::apps
