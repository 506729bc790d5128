// Results of a monitoring run: summary.json, the rows of series.csv, and what the terminal shows.
#pragma once

#include <iosfwd>
#include <string>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/monitoring/monitor.hpp"

namespace wheeltap::apps {

/// "time,f1 [Hz],f1 predicted,f1 sd,f1 corrected,…,log statistic,P(changed),alarm".
[[nodiscard]] std::string series_header(const MonitorCaseFile& parsed);

/// Row i of series.csv, in the unit of the features; cells of missing values are empty.
[[nodiscard]] std::string series_row(const MonitorCaseFile& parsed, int i,
                                     const identification::monitoring::RowFinding& row);

/// summary.json: about the run, and /monitor.
[[nodiscard]] Report monitor_summary(const MonitorCaseFile& parsed,
                                     const identification::monitoring::Monitor& monitor,
                                     const RunInfo& info);

/// The answer, the alarms and the rates.
void print_monitor(std::ostream& out, const MonitorCaseFile& parsed, const Report& summary,
                   bool colour);

/// One sentence: whether there was an alarm, since when, and how sure.
[[nodiscard]] std::string monitor_headline(const Report& monitor);
/// One sentence: the stated rate of false alarms, and the rate in replayed healthy rows. A series
/// without a clock states rows between two false alarms.
[[nodiscard]] std::string false_alarms_in_words(const Report& monitor);

/// "f2 [Hz] by -1.9 % ± 0.2 %", the features that shifted most clearly first.
[[nodiscard]] std::string shifts_in_words(const Report& alarm);

}  // namespace wheeltap::apps
