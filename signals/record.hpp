// Measured records: columns sampled at the same times.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/formats/formats.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::signals {

/// A table whose row n is sample n.
struct Record : io::Columns {
  [[nodiscard]] int samples() const { return rows(); }
  /// The time column, -1 if there is none. A column is the time column by its name: "time", "t", a
  /// name that begins with "time", or the name of time in another language or in the files of a
  /// logger. If no name fits, it is the first column of time stamps. A column of texts is never it.
  [[nodiscard]] int find_time() const;
};

/// Options for reading a file: columns and layout.
struct RecordReading {
  std::vector<std::string> columns = {};  ///< as in io::Columns::find; empty: all
  std::vector<std::string> ignored = {};  ///< not read, not even as time
  io::TextLayout layout = {};             ///< for delimited text
  io::ArrayLayout arrays = {};            ///< for files of arrays
};

/// Reads a record as delimited text (io/tables/delimited_text.hpp). Reads only the named columns
/// (see io::Columns::find) and time, or all if no names are given; the others may hold anything.
/// Throws io::FileError.
[[nodiscard]] Record parse_record(std::string bytes, const std::filesystem::path& name,
                                  std::vector<std::string> columns = {});

/// Reads a record in any known format.
[[nodiscard]] Record read_record(const std::filesystem::path& path, RecordReading reading = {},
                                 std::span<const io::Format> known = io::formats());

/// The sampling according to a time column.
struct Sampling {
  enum class Basis {
    unit,     ///< from the column's header or name
    scale,    ///< from the caller
    stamps,   ///< dates and times of day
    epoch,    ///< counts since 1970, so large that only this unit is possible
    days,     ///< a spreadsheet's dates: days since 1900, or since year 0
    assumed,  ///< no unit: seconds
    header,   ///< no time column: a line above the rows gives the rate
    stated    ///< no time column, or a too coarse one: the case states the rate
  };
  double rate_hz = 0.0;
  Basis basis = Basis::stated;
  std::string unit = {};  ///< unit of the column's numbers
  /// Largest relative difference of a step from the mean step that the printed digits do not
  /// explain; 0 if below 0.1 %.
  double jitter = 0.0;
  /// True if there is no unit and times are whole numbers in steps of two or more: possibly
  /// milliseconds.
  bool doubtful_unit = false;
  int line = 0;  ///< line with the rate, for Basis::header
  double off_grid =
      0.0;  ///< largest distance of a time stamp from an even grid, in steps; 0 without jitter
};

/// Determines the sampling from a time column. If `scale` [s] does not give the length of one unit,
/// the unit is that of the header or the name, otherwise seconds (or one of Sampling::Basis). Every
/// time step must equal the mean time step within 1 % and the printed precision. Throws
/// io::FileError (corrupt) with the line for NaN, decreasing times, gaps and uneven steps; also for
/// an unknown time unit, and if `stated` differs by more than 0.1 %.
[[nodiscard]] Sampling sampling_of(const Record& record, int time_column,
                                   std::optional<double> stated = std::nullopt,
                                   std::optional<double> scale = std::nullopt);

/// The sampling rate from a line above the rows of a text: "Fs = 100 Hz", "Sample interval (s):
/// 0.01". std::nullopt if no line states a rate, or if lines state different rates.
[[nodiscard]] std::optional<Sampling> sampling_from_header(const Record& record);

/// Resamples all columns that were read to an even rate, `rate_hz` or the mean rate, by natural
/// cubic splines through their samples. Throws io::FileError (corrupt) with the line if time does
/// not increase, a step is longer than five median steps, or a value is not finite.
[[nodiscard]] Record resampled(const Record& record, int time_column, std::optional<double> rate_hz,
                               std::optional<double> scale = std::nullopt);

/// The rate [Hz] of the resampled record.
[[nodiscard]] double sample_rate_hz(const Record& record, int time_column,
                                    std::optional<double> stated = std::nullopt,
                                    std::optional<double> scale = std::nullopt);

/// Samples [begin, end) of a column. Throws io::FileError (corrupt) if the window is empty or
/// exceeds the record, or holds a value that is not finite (with its line).
[[nodiscard]] std::vector<double> window(const Record& record, int column, int begin, int end);

/// A record as CSV text, with a comment line and a header line; 17 digits per number preserve every
/// bit.
[[nodiscard]] std::string record_csv(const Record& record, const std::string& comment,
                                     int digits = 10);

}  // namespace wheeltap::signals
