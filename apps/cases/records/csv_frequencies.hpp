// Frequencies in CSV files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/failure.hpp"

namespace wheeltap::apps {

/// Location of the frequencies in a CSV file.
struct FrequencyCells {
  /// For a file with one test per row: names or 1-based numbers of the columns of modes 1, 2, …. If
  /// the list is empty, the file has one mode per row, in a column "frequency" and optionally the
  /// columns "sd" and "mode" (or "number"). Units in brackets are allowed. `wheeltap simulate`
  /// writes files with one mode per row.
  std::vector<std::string> columns;
  /// 1-based row of the test below the header; used with `columns`. The row may be omitted if the
  /// file has only one row.
  std::optional<int> row = {};
};

struct FrequencyTable {
  std::vector<double> frequencies_hz;  ///< of modes 1, 2, …; NaN for a mode not measured
  std::vector<double> sd_hz;           ///< standard deviations; empty if the file has none
};

/// Parses frequencies in delimited text (io/tables/delimited_text.hpp) with a header line. `name`
/// is the name of the file in messages. A column "mode" or "number" holds the numbers of the modes:
/// increasing whole numbers. Without this column, the rows are modes 1, 2, ….
///
/// Throws Failure (65), with line and column, for a cell that is not a positive finite number, for
/// a missing row or column, and for mode numbers that do not increase. Also throws Failure (65) if
/// the number of a mode is unclear: for an empty line between the rows, and for another column of
/// increasing whole numbers without a unit. Throws io::FileError (corrupt) for an invalid table.
[[nodiscard]] FrequencyTable parse_frequency_csv(std::string bytes,
                                                 const std::filesystem::path& name,
                                                 const FrequencyCells& cells);

/// Reads and parses a file with parse_frequency_csv. Also throws Failure (66) for an unreadable
/// file.
[[nodiscard]] FrequencyTable read_frequency_csv(const std::filesystem::path& path,
                                                const FrequencyCells& cells);

/// Parses the frequencies of repeated tests. The text has one test per row and one mode per column.
/// `columns` are the names (or 1-based numbers) of the columns of modes 1, 2, …. If the list is
/// empty, this function uses the columns with a unit of frequency. If no column has a unit of
/// frequency, the function uses all columns. The result has one row per test, in Hz, with NaN for a
/// missing value. Every row must have as many cells as the header. Throws like parse_frequency_csv.
[[nodiscard]] std::vector<std::vector<double>> parse_repeats_csv(
    std::string bytes, const std::filesystem::path& name, const std::vector<std::string>& columns);

/// Reads and parses a file with parse_repeats_csv. Also throws Failure (66) for an unreadable file.
[[nodiscard]] std::vector<std::vector<double>> read_repeats_csv(
    const std::filesystem::path& path, const std::vector<std::string>& columns);

/// CSV text with the columns mode, frequency and standard deviation, one mode per row.
[[nodiscard]] std::string frequency_csv(const FrequencyTable& table, const std::string& comment);

}  // namespace wheeltap::apps
