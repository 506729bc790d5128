// Measured records: columns that were sampled together.
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
  /// The column called time or t, or with a name that begins with "time" or is a usual one for it
  /// in another language or logger; else the first of time stamps; -1 if there is none. A column of
  /// texts is none.
  [[nodiscard]] int find_time() const;
};

/// What of a file is read, and how it is laid out.
struct RecordReading {
  std::vector<std::string> columns = {};  ///< as io::Columns::find knows them; all where empty
  std::vector<std::string> ignored = {};  ///< not read, not even as time
  io::TextLayout layout = {};             ///< of delimited text
  io::ArrayLayout arrays = {};            ///< of files of arrays
};

/// A record as delimited text (io/tables/delimited_text.hpp). Of the columns only those called so
/// (see io::Columns::find) and time are read, all where no names are given: the others may hold
/// anything. Throws io::FileError.
[[nodiscard]] Record parse_record(std::string bytes, const std::filesystem::path& name,
                                  std::vector<std::string> columns = {});

/// The same of a file in any format that is known.
[[nodiscard]] Record read_record(const std::filesystem::path& path, RecordReading reading = {},
                                 std::span<const io::Format> known = io::formats());

/// What a time column says of the sampling.
struct Sampling {
  enum class Basis {
    unit,     ///< of the column's header or name
    scale,    ///< the caller's
    stamps,   ///< dates and times of day
    epoch,    ///< counts since 1970 so large that they must be of this unit
    days,     ///< a spreadsheet's dates: days since 1900, or since year 0
    assumed,  ///< no unit: seconds
    header,   ///< no time column: a line above the rows says the rate
    stated    ///< no time column, or one too coarse: the rate was stated
  };
  double rate_hz = 0.0;
  Basis basis = Basis::stated;
  std::string unit = {};  ///< of the column's numbers
  /// Largest difference of a step from the mean one, over the latter, that the digits printed do
  /// not explain; 0 where it is below 0.1 %.
  double jitter = 0.0;
  /// No unit, and times are whole numbers in steps of two and more: they may be milliseconds.
  bool doubtful_unit = false;
  int line = 0;           ///< that says the rate, of Basis::header
  double off_grid = 0.0;  ///< how far a time stamp is off an even grid, in steps; 0 without jitter
};

/// Its unit is the header's or the name's, else seconds (or what Sampling::Basis has), unless
/// `scale` [s] says how long one is. Every step must equal the mean one within 1 % and the digits
/// printed. Throws io::FileError (corrupt), naming the line, for NaN, time running backwards, gaps
/// and uneven steps; for a unit that is no known one of time; and if `stated` differs by more than
/// 0.1 %.
[[nodiscard]] Sampling sampling_of(const Record& record, int time_column,
                                   std::optional<double> stated = std::nullopt,
                                   std::optional<double> scale = std::nullopt);

/// The rate that a line above the rows of a text says: "Fs = 100 Hz", "Sample interval (s): 0.01".
/// Nothing where there is none, or two that differ.
[[nodiscard]] std::optional<Sampling> said_sampling(const Record& record);

/// The record at an even rate: all columns that were read, by natural cubic splines through their
/// samples, at `rate_hz` or the mean rate. Throws io::FileError (corrupt), naming the line, where
/// time does not increase, a step is longer than five median ones, or a value is not finite.
[[nodiscard]] Record resampled(const Record& record, int time_column, std::optional<double> rate_hz,
                               std::optional<double> scale = std::nullopt);

/// The rate [Hz] of that.
[[nodiscard]] double sample_rate_hz(const Record& record, int time_column,
                                    std::optional<double> stated = std::nullopt,
                                    std::optional<double> scale = std::nullopt);

/// Samples [begin, end) of a column. Throws io::FileError (corrupt) if the window is empty, reaches
/// beyond the record, or holds a value that is not finite (naming its line).
[[nodiscard]] std::vector<double> window(const Record& record, int column, int begin, int end);

/// A record as CSV text, after a line of comment and one of headers; 17 digits a number keep every
/// bit.
[[nodiscard]] std::string record_csv(const Record& record, const std::string& comment,
                                     int digits = 10);

}  // namespace wheeltap::signals
