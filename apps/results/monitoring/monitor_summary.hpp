// Results of a monitoring run: summary.json, the rows of series.csv, and the terminal text.
#pragma once

#include <iosfwd>
#include <string>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/results/summary.hpp"
#include "identification/monitoring/monitor.hpp"

namespace wheeltap::apps {

/// Header "time,f1 [Hz],f1 predicted,f1 sd,f1 corrected,…,log statistic,P(changed),alarm".
[[nodiscard]] std::string series_header(const MonitorCaseFile& parsed);

/// Row i of series.csv, in the unit of the features; cells of missing values are empty.
[[nodiscard]] std::string series_row(const MonitorCaseFile& parsed, int i,
                                     const identification::monitoring::RowFinding& row);

/// Content of summary.json: information about the run, and /monitor.
[[nodiscard]] Report monitor_summary(const MonitorCaseFile& parsed,
                                     const identification::monitoring::Monitor& monitor,
                                     const RunInfo& info);

/// Prints the headline, the alarms and the rates of false alarms.
void print_monitor(std::ostream& out, const MonitorCaseFile& parsed, const Report& summary,
                   bool colour);

/// Returns a sentence on the time, onset and probability of the last alarm. Without an alarm, the
/// sentence gives P(changed).
[[nodiscard]] std::string monitor_headline(const Report& monitor);
/// Sentences with the stated rate of false alarms, the threshold that gives this rate, and the rate
/// in simulated healthy rows (Replay). For a series without times, the rates refer to rows.
[[nodiscard]] std::string false_alarms_in_words(const Report& monitor);

/// "f2 [Hz] by -1.90 % (sd 0.20 %)": shifts whose 95 % interval excludes zero, the most significant
/// shift first.
[[nodiscard]] std::string shifts_in_words(const Report& alarm);

}  // namespace wheeltap::apps
