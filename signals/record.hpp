// Measured records: columns sampled at the same times.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/formats/formats.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::signals {

/// A measured record as a table. Row n holds sample n of all channels.
struct Record : io::Columns {
  [[nodiscard]] int samples() const { return rows(); }
  /// Returns the index of the time column, or -1 if the record has no time column. A time column
  /// has one of these names: "time", "t", a name that begins with "time", the word for time in
  /// another language, or a name that a logger uses. If no column has such a name, the time column
  /// is the first column of time stamps. A column of strings is never the time column.
  [[nodiscard]] int find_time() const;
};

/// Options for reading a file: columns to read, and layout.
struct RecordReading {
  std::vector<std::string> columns = {};  ///< headers, names or numbers of columns
                                          ///< (io::Columns::find); empty: all
  std::vector<std::string> ignored = {};  ///< columns to ignore, also as time column
  io::TextLayout layout = {};             ///< layout of delimited text
  io::ArrayLayout arrays = {};            ///< layout of files of arrays
};

/// Reads a record as delimited text (io/tables/delimited_text.hpp). Reads only the named columns
/// (see io::Columns::find) and the time column, or all columns if `columns` is empty. Columns that
/// are not read may have any content. Throws io::FileError.
[[nodiscard]] Record parse_record(std::string bytes, const std::filesystem::path& name,
                                  std::vector<std::string> columns = {});

/// Reads a record in any of the formats `known`. Throws io::FileError.
[[nodiscard]] Record read_record(const std::filesystem::path& path, RecordReading reading = {},
                                 std::span<const io::Format> known = io::formats());

/// The sampling that a time column defines.
struct Sampling {
  enum class Basis {
    unit,     ///< the header or the name of the time column gives the unit
    scale,    ///< the caller gives the duration of one unit
    stamps,   ///< dates and times of day
    epoch,    ///< counts since 1970; the counts are so large that only this unit is possible
    days,     ///< a spreadsheet's dates: days since 1900, or since year 0
    assumed,  ///< no unit is given; seconds are assumed
    header,   ///< no time column: a line above the rows gives the rate
    stated    ///< no time column, or times that are too coarse: the case states the rate
  };
  double rate_hz = 0.0;
  Basis basis = Basis::stated;
  std::string unit = {};  ///< unit of the column's numbers
  /// Largest relative difference between a time step and the mean time step, minus the difference
  /// due to the rounding of the printed times. The value is 0 if the result is below 0.1 %.
  double jitter = 0.0;
  /// True if the time column has no unit and the times are whole numbers in steps of two or more.
  /// The unit could then be milliseconds instead of seconds.
  bool doubtful_unit = false;
  int line = 0;  ///< number of the line that gives the rate, for Basis::header
  double off_grid =
      0.0;  ///< largest distance of a time stamp from a uniform grid [time steps]; 0 without jitter
};

/// Determines the sampling interval from a time column. `scale` [s] gives the duration of one unit
/// of the column. Without `scale`, the unit comes from the column's header or name or, if these
/// give none, from the values (see Sampling::Basis); the default is seconds. Every time step must
/// equal the mean time step within 1 % plus the rounding of the printed times. Throws io::FileError
/// (corrupt), with the line number, for NaN, decreasing times, gaps and uneven steps. Also throws
/// io::FileError for an unknown time unit, and if `stated` differs from the rate of the time column
/// by more than 0.1 %.
[[nodiscard]] Sampling sampling_of(const Record& record, int time_column,
                                   std::optional<double> stated = std::nullopt,
                                   std::optional<double> scale = std::nullopt);

/// Returns the sampling rate that a line above the rows of a text file states: "Fs = 100 Hz",
/// "Sample interval (s): 0.01". Returns std::nullopt if no line states a rate, or if lines state
/// different rates.
[[nodiscard]] std::optional<Sampling> sampling_from_header(const Record& record);

/// Resamples all columns that were read to a constant rate, with natural cubic splines through the
/// samples. The new rate is `rate_hz`, or the mean rate if `rate_hz` is not set. A filter removes
/// the frequencies that a lower rate cannot represent (`decimate` in spectra.hpp). Throws
/// io::FileError (corrupt), with the line number, if time does not increase, a time step exceeds
/// five median time steps, or a value is not finite.
[[nodiscard]] Record resampled(const Record& record, int time_column, std::optional<double> rate_hz,
                               std::optional<double> scale = std::nullopt);

/// Returns the sampling rate [Hz] of a record; the arguments are those of `sampling_of`.
[[nodiscard]] double sample_rate_hz(const Record& record, int time_column,
                                    std::optional<double> stated = std::nullopt,
                                    std::optional<double> scale = std::nullopt);

/// Returns samples [begin, end) of a column. Throws io::FileError (corrupt) if this window is empty
/// or exceeds the record, or if a value in the window is not finite (with the line number of the
/// value).
[[nodiscard]] std::vector<double> window(const Record& record, int column, int begin, int end);

/// Writes a record as CSV text, with a comment line and a header line. `digits` is the number of
/// significant digits; 17 digits preserve every bit of a number.
[[nodiscard]] std::string record_csv(const Record& record, const std::string& comment,
                                     int digits = 10);

}  // namespace wheeltap::signals
