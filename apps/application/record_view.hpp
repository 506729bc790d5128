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

/// A measured file, and the layout of this file as given in a case.
struct RecordSource {
  std::filesystem::path path;
  io::TextLayout layout = {};
  io::ArrayLayout arrays = {};
  bool resample = false;                      ///< interpolate uneven time steps
  std::optional<double> sample_rate_hz = {};  ///< rate of the interpolated record [Hz]
  std::string stated = {};  ///< the keys of the case that state the layout, as JSON; may be empty
};

/// The most recently opened files, identified by path, stated layout, size and time of the last
/// change.
class OpenRecords {
 public:
  /// Reads the file if it is not in memory. The channels are not checked. Throws
  /// io::FileError, Failure.
  [[nodiscard]] std::shared_ptr<const MeasuredFile> open(const RecordSource& source);
  /// Opens the file and checks its channels, which can take longer than reading it. Returns
  /// {tables: [[{rms, faults, peaks_hz, missing, lowest, highest}, …], …]}, one object for each
  /// channel. `missing` is the fraction of samples that are not finite.
  [[nodiscard]] Report checked(const RecordSource& source);

 private:
  struct Opened {
    std::filesystem::path path;
    std::string stated = {};
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type changed = {};
    std::shared_ptr<MeasuredFile> file = {};
    Report checked = {};  ///< null before the check
  };
  /// The entry of a file; the caller must hold mutex_.
  Opened& entry_of(const RecordSource& source);
  std::mutex mutex_, checking_;
  std::list<Opened> opened_;  // most recently used first
};

/// Returns {format, tables: [{rows, sample_rate_hz, reading, channels: [{name, unit}, …],
/// time_column, times: {from, to, unit, start}, left_out: [{name, number, is_time_stamp}, …]}, …]}.
/// `times` is the range of the time column. `left_out` are the columns that are not channels.
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
/// window. The lists are empty if the sampling rate is unknown, if the window has fewer than 16
/// rows, or if a value is not finite. Throws std::invalid_argument like record_window.
[[nodiscard]] Report record_spectrum(const MeasuredFile& file, const RecordWindow& window);

}  // namespace wheeltap::apps
