// Frequencies from CSV files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/failure.hpp"

namespace wheeltap::apps {

/// Which cells of a CSV file hold the frequencies.
struct FrequencyCells {
  /// Names of the columns of mode 1, 2, … of a file with one test a row (or their 1-based numbers).
  /// Empty: the file has one mode a row, in a column "frequency" and optionally "sd" (units in
  /// brackets are allowed), as `wheeltap simulate` writes it.
  std::vector<std::string> columns;
  int row = 1;  ///< 1-based, below the header, where there are columns
};

struct FrequencyTable {
  std::vector<double> frequencies_hz;  ///< NaN for an empty cell: not measured
  std::vector<double> sd_hz;           ///< empty where the file has none
};

/// Frequencies in delimited text (io/tables/delimited_text.hpp) with a header line. `name` stands
/// for the file in messages. Throws Failure (65) naming line and column for a cell that is no
/// positive finite number, a row or column that is not there, and io::FileError (corrupt) for what
/// is no such text.
[[nodiscard]] FrequencyTable parse_frequency_csv(std::string bytes,
                                                 const std::filesystem::path& name,
                                                 const FrequencyCells& cells);

/// The same of a file. Throws Failure (66) for one that cannot be read besides.
[[nodiscard]] FrequencyTable read_frequency_csv(const std::filesystem::path& path,
                                                const FrequencyCells& cells);

/// Writes mode, frequency and standard deviation, one mode a row.
[[nodiscard]] std::string frequency_csv(const FrequencyTable& table, const std::string& comment);

}  // namespace wheeltap::apps
