// A monitor case: a table of features and covariates, and a period in which the structure is
// healthy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/monitoring/monitored_modes.hpp"
#include "apps/cases/monitoring/monitored_structure.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"
#include "identification/monitoring/monitor.hpp"
#include "signals/record.hpp"

namespace wheeltap::apps {

/// The format of the times in the series.
struct TimeAxis {
  double hours_per_unit = 1.0;
  std::string unit = "h";                              ///< "s", "min", "h", "d", "row" or "date"
  std::optional<std::int64_t> start_nanoseconds = {};  ///< time zero of dates [ns since 1970]
  bool has_zone = false;  ///< true if dates state their offset from UTC
  /// Converts a time in hours to the format of the case: a number, or a string for dates.
  [[nodiscard]] Report written(double hours) const;
  /// A time in hours as text in this format, for tables and messages.
  [[nodiscard]] std::string text(double hours) const;
};

/// Information about tests whose modes are the features.
struct TrackedTests {
  std::vector<std::string> names = {};  ///< file of each test (row)
  std::vector<identification::monitoring::TrackedMode> modes = {};
  /// n x K (tests x tracked modes): the probability that the mode is assigned correctly or, if the
  /// mode is missing from the test, the probability that it is absent.
  Eigen::MatrixXd probability = {};
  std::vector<std::uint64_t> checksums = {};  ///< checksums of the files' contents
};

struct MonitorCaseFile {
  CaseFile file;
  std::string title;
  TimeAxis time = {};
  identification::monitoring::Series series = {};  ///< all rows of the table
  Eigen::MatrixXd features = {};                   ///< n x p (rows x features): values of the table
  int learning_rows = 0;
  identification::monitoring::MonitorOptions options = {};
  /// Set if the features come from modes or records
  std::optional<TrackedTests> tests = {};
  std::optional<MonitoredStructure> structure = {};  ///< structure with which changes are explained
  std::vector<std::string> warnings = {};
};

/// Reads the case and its table, or the modes of its tests. Throws Failure (65) with one line that
/// names the file, the key or the row, the value and a remedy. Faults are: times that repeat or
/// decrease; features that are not positive; features that are missing or constant in the training
/// period; a training period that is empty or has not ended.
[[nodiscard]] MonitorCaseFile parse_monitor_case(CaseFile file, const ModesReading& reading = {});

/// The location of the key that names the files of the series in a valid case: /series/file,
/// /series/modes or /series/records/files.
[[nodiscard]] Pointer source_of(const CaseFile& file);

/// Returns a text with the path, size and modification time of each file of the series. The text
/// changes if a file is added or written. The text is empty if the case cannot be read.
[[nodiscard]] std::string files_now(const CaseFile& file);

}  // namespace wheeltap::apps
