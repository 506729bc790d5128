// Warnings about columns of a monitored series that are probably wrong.
#pragma once

namespace wheeltap::apps {

struct MonitorCaseFile;

/// Warns of covariates of the training period that are probably error codes, such as -999: more
/// than kLargestDeviation robust standard deviations from the median.
void warn_of_error_codes(MonitorCaseFile& out);

/// Warns of columns whose values are missing or equal in all last rows. These last rows must be
/// more than in any gap, or in any sequence of equal values, of the training period.
void warn_of_dead_columns(MonitorCaseFile& out);

}  // namespace wheeltap::apps
