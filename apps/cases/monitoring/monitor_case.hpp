// A monitor case: a table of features and covariates, and the period known to be healthy.
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

/// How times of the series are written.
struct TimeAxis {
  double hours_per_unit = 1.0;
  std::string unit = "h";                              ///< "s", "min", "h", "d", "row"; "date"
  std::optional<std::int64_t> start_nanoseconds = {};  ///< of dates: since 1970
  bool has_zone = false;  ///< true if dates state their offset from UTC
  /// A time in hours as the case writes it: a number, or a text for dates.
  [[nodiscard]] Report written(double hours) const;
  /// The same as text, for tables and sentences.
  [[nodiscard]] std::string text(double hours) const;
};

/// How tests were read whose modes are the features.
struct TrackedTests {
  std::vector<std::string> names = {};  ///< file of each row
  std::vector<identification::monitoring::TrackedMode> modes = {};
  /// n x K: probability of the assignment of a tracked mode, or that it is missing.
  Eigen::MatrixXd probability = {};
  std::vector<std::uint64_t> checksums = {};  ///< over the files' contents
};

struct MonitorCaseFile {
  CaseFile file;
  std::string title;
  TimeAxis time = {};
  identification::monitoring::Series series = {};  ///< all rows of the table
  Eigen::MatrixXd features = {};                   ///< n x p: as in the table
  int learning_rows = 0;
  identification::monitoring::MonitorOptions options = {};
  std::optional<TrackedTests> tests = {};            ///< where the series is of modes or records
  std::optional<MonitoredStructure> structure = {};  ///< to explain changes
  std::vector<std::string> warnings = {};
};

/// Reads the case and its table, or the modes of its tests. Throws Failure (65) with one line that
/// names the file, the key or the row, the value and a remedy. Faults are times that repeat or
/// decrease, features that are not positive or are missing or constant in the learning period, and
/// a learning period that is empty or not over.
[[nodiscard]] MonitorCaseFile parse_monitor_case(CaseFile file, const ModesReading& reading = {});

/// The key of a valid case that names the series' files: /series/file, /series/modes or
/// /series/records/files.
[[nodiscard]] Pointer source_of(const CaseFile& file);

/// The state of the files of the series, as text: it changes when one is added or written. Empty
/// where the case cannot be read.
[[nodiscard]] std::string files_now(const CaseFile& file);

}  // namespace wheeltap::apps
