// Measured files for the data viewer: windows of their channels with a bounded number of points.
#pragma once

#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/records/measured_file.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// The most recently opened files, identified by path, size and time of the last change.
class OpenRecords {
 public:
  /// Reads the file unless it is still in memory. The channels are not checked. Throws
  /// io::FileError, Failure.
  [[nodiscard]] std::shared_ptr<const MeasuredFile> open(const std::filesystem::path& path);
  /// Opens the file and checks its channels; the check can take longer than the reading. Returns
  /// {tables: [[{rms, faults, peaks_hz}, …], …]}, one object for each channel.
  [[nodiscard]] Report checked(const std::filesystem::path& path);

 private:
  struct Opened {
    std::filesystem::path path;
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type changed = {};
    std::shared_ptr<MeasuredFile> file = {};
    Report checked = {};  ///< null before the check
  };
  /// The entry of a file; the caller must hold mutex_.
  Opened& entry_of(const std::filesystem::path& path);
  std::mutex mutex_, checking_;
  std::list<Opened> opened_;  // most recently used first
};

/// Returns {format, tables: [{rows, sample_rate_hz, reading, channels: [{name, unit}, …]}, …]}.
[[nodiscard]] Report record_contents(const MeasuredFile& file);

/// A window of a table.
struct RecordWindow {
  std::size_t table = 0;
  std::vector<std::size_t> channels = {};
  long begin = 0, end = 0;  ///< rows [begin, end), limited to the rows of the table
  long points = 1000;       ///< largest number of intervals (see record_window)
  std::optional<double> sample_rate_hz = {};  ///< sampling rate [Hz] if the table states none
};

/// Returns {begin, end, exact, step, channels: [{low: […], high: […]}, …]}. The window is divided
/// into intervals of `step` rows. `low` and `high` are the smallest and largest value of each
/// interval, or null if none is finite. If `exact` is true, an interval is one row, and `high` is
/// omitted. Throws std::invalid_argument for a table, a channel or a window that does not exist.
[[nodiscard]] Report record_window(const MeasuredFile& file, const RecordWindow& window);

/// Returns {frequencies_hz, density: […]}: the Welch power spectral density of one channel in the
/// window. The lists are empty if the sampling rate is unknown, for fewer than 16 rows, and for
/// values that are not finite. Throws std::invalid_argument like record_window.
[[nodiscard]] Report record_spectrum(const MeasuredFile& file, const RecordWindow& window);

}  // namespace wheeltap::apps
