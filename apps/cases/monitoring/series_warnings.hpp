// Warnings about columns of a monitored series that are probably wrong.
#pragma once

namespace wheeltap::apps {

struct MonitorCaseFile;

/// Warns of covariate values in the training period that are probably error codes, such as -999:
/// more than kLargestDeviation robust standard deviations from the median.
void warn_of_error_codes(MonitorCaseFile& out);

/// Warns of columns that end in a sequence of missing or of equal values. The function warns only
/// if this sequence is longer than every sequence of the same type in the training period.
void warn_of_dead_columns(MonitorCaseFile& out);

}  // namespace wheeltap::apps
