// Tables of model runs in NetCDF-4 files: several tables a file, each with its factors, units and
// measured error, under attributes that say what they were computed from.
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// A file that could not be read or written, and why.
class FileError : public std::runtime_error {
 public:
  enum class Kind {
    missing,    ///< not there, or not readable
    corrupt,    ///< truncated, damaged, or contradicting itself
    foreign,    ///< another program's file, or not a table file at all
    version,    ///< a format of another version of this program
    mismatch,   ///< a table made for something else (its fingerprint differs)
    unwritable  ///< cannot be created there
  };
  FileError(Kind kind, std::filesystem::path path, std::string reason)
      : std::runtime_error(path.string() + ": " + reason),
        kind_(kind),
        path_(std::move(path)),
        reason_(std::move(reason)) {}
  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  Kind kind_;
  std::filesystem::path path_;
  std::string reason_;
};

/// 64-bit FNV-1a of the text, as 16 hexadecimal digits: tells two cases apart, not a defence.
[[nodiscard]] std::string fingerprint(std::string_view text);

/// Runs of the model on a full-factorial grid.
struct Table {
  std::vector<Factor> factors;
  std::string response_name;          ///< e.g. "frequency"
  std::string response_unit;          ///< e.g. "Hz"
  RowMatrix values;                   ///< runs × responses, rows in the order of `full_factorial`
  std::vector<HoldoutError> holdout;  ///< one per response, or empty where never measured
};

/// All that a file holds.
struct TableFile {
  /// Global text attributes, e.g. "case" (JSON text), "fingerprint", "wheeltap_version", "command".
  std::map<std::string, std::string> attributes;
  /// By group name, e.g. "count_1": the table of runs with one damage.
  std::map<std::string, Table> tables;
};

/// The version of the layout below, kept in the global attribute `table_format_version`.
///   group NAME: dimensions = factors (coordinate variables with `units` and `scale`) and
///   `response`; variable RESPONSE_NAME(factor…, response) with `units`; where measured, variables
///   holdout_{rmse,max_error,spread,q2}(response).
inline constexpr int kTableFormatVersion = 1;

/// Writes under a temporary name in the same directory and renames, so that `path` is never
/// half-written. Throws FileError (unwritable), and std::invalid_argument for tables whose shapes
/// disagree, that have no values, or names that NetCDF does not take.
void write_table_file(const std::filesystem::path& path, const TableFile& file);

/// Reads everything. With `expected_fingerprint` the attribute "fingerprint" must equal it.
/// Throws FileError.
[[nodiscard]] TableFile read_table_file(const std::filesystem::path& path,
                                        std::string_view expected_fingerprint = {});

}  // namespace wheeltap::emulator
