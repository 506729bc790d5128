// Measured records: named columns of equal length, read from CSV or MATLAB files.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace wheeltap::signals {

/// A file that is not there or cannot be read.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file whose content is wrong; the message names the file and, where there is one, line and
/// column (both from 1).
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Column {
  std::string header;  ///< as in the file: "force [N]", "X1(:,2)"; "3" in a file without a header
  std::string name;    ///< "force"
  std::string unit;    ///< "N", or empty
  std::vector<double> values;
  /// How finely the file prints a number: its most digits after the point and most significant
  /// digits. Negative for binary files.
  int decimals = -1;
  int digits = -1;
};

struct Record {
  std::string file;
  std::vector<Column> columns;
  std::map<std::string, double> scalars;  ///< single numbers in a MATLAB file
  int first_line = 0;                     ///< line of sample 0; 0 for binary files

  [[nodiscard]] int samples() const {
    return columns.empty() ? 0 : static_cast<int>(columns.front().values.size());
  }
  /// Index of the column with this header, or this name, or (a number) at this place from 1. Throws
  /// DataError, naming what there is, if there is none or several.
  [[nodiscard]] int find(std::string_view column) const;
  /// The column called time or t, or with a name that begins with "time"; -1 if there is none.
  [[nodiscard]] int find_time() const;
};

/// Reads a table separated by commas, semicolons or tabs, with or without one line of headers
/// ("force [N]" or "force (N)": name and unit), after any lines that begin with '#'. Empty cells
/// and "nan" become NaN. Throws FileError, and DataError for unequal columns or text that is no
/// number.
[[nodiscard]] Record read_csv(const std::filesystem::path& path);

/// Reads the real numeric arrays of a MATLAB v5 file (libmatio). A vector is one column under its
/// name, a matrix "X1" the columns "X1(:,1)", "X1(:,2)", …; arrays shorter than the longest are
/// left out. Throws FileError, also where the library was built without libmatio.
[[nodiscard]] Record read_matlab(const std::filesystem::path& path);

/// By the file's ending: .mat, or anything else as CSV.
[[nodiscard]] Record read_record(const std::filesystem::path& path);

/// The sampling rate [Hz] that a time column [s] says. Every step must equal the mean one within
/// 0.1 % and the digits printed. Throws DataError, naming the line, for NaN, time running
/// backwards, gaps and uneven steps, and if `stated` differs by more than 0.1 %.
[[nodiscard]] double sample_rate_hz(const Record& record, int time_column,
                                    std::optional<double> stated = std::nullopt);

/// Samples [begin, end) of a column. Throws DataError if the window is empty, reaches beyond the
/// record, or holds a value that is not finite (naming its line).
[[nodiscard]] std::vector<double> window(const Record& record, int column, int begin, int end);

/// A record as CSV text, ten digits a number, after a line of comment and one of headers.
[[nodiscard]] std::string record_csv(const Record& record, const std::string& comment);

}  // namespace wheeltap::signals
