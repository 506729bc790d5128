// Measured records: columns that were sampled together.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/columns.hpp"
#include "io/formats.hpp"

namespace wheeltap::signals {

/// A table whose row n is sample n.
struct Record : io::Columns {
  [[nodiscard]] int samples() const { return rows(); }
  /// The column called time or t, or with a name that begins with "time"; -1 if there is none.
  [[nodiscard]] int find_time() const;
};

/// A record as delimited text (io/delimited_text.hpp). Of the columns only those called so (see
/// io::Columns::find) and time are read, all where no names are given: the others may hold
/// anything. Throws io::FileError.
[[nodiscard]] Record parse_record(std::string bytes, const std::filesystem::path& name,
                                  std::vector<std::string> columns = {});

/// The same of a file in any format that is known.
[[nodiscard]] Record read_record(const std::filesystem::path& path,
                                 std::vector<std::string> columns = {},
                                 std::span<const io::Format> known = io::formats());

/// The sampling rate [Hz] that a time column says. Its unit is the header's, seconds where there is
/// none, unless `scale` [s] says how long one is. Every step must equal the mean one within 0.1 %
/// and the digits printed. Throws io::FileError (corrupt), naming the line, for NaN, time running
/// backwards, gaps and uneven steps; for a unit that is no known one of time; and if `stated`
/// differs by more than 0.1 %.
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
