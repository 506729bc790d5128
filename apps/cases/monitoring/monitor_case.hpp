// A monitor case: a table of features and covariates, and the period known to be healthy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/monitoring/monitored_structure.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "identification/monitoring/monitor.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

/// How times of the series are written.
struct TimeAxis {
  double hours_per_unit = 1.0;
  std::string unit = "h";                              ///< "s", "min", "h", "d", "row"; "date"
  std::optional<std::int64_t> start_nanoseconds = {};  ///< of dates: since 1970
  /// A time in hours as the case writes it: a number, or a text for dates.
  [[nodiscard]] Report written(double hours) const;
  /// The same as text, for tables and sentences.
  [[nodiscard]] std::string text(double hours) const;
};

struct MonitorCaseFile {
  CaseFile file;
  std::string title;
  TimeAxis time = {};
  identification::monitoring::Series series = {};  ///< all rows of the table
  Eigen::MatrixXd features = {};                   ///< n x p: as in the table
  int learning_rows = 0;
  identification::monitoring::MonitorOptions options = {};
  std::optional<MonitoredStructure> structure = {};  ///< to explain changes
  std::vector<std::string> warnings = {};
};

/// Reads the case and its table. Throws Failure (65) with one line that names the file, the key or
/// the row, the value and a remedy. Faults are times that repeat or decrease, features that are not
/// positive or are missing or constant in the learning period, and a learning period that is empty
/// or not over.
[[nodiscard]] MonitorCaseFile parse_monitor_case(CaseFile file);

}  // namespace wheeltap::apps
