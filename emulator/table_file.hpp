// Tables of model runs in NetCDF-4 files: several tables a file, each with its factors, units and
// measured error, under attributes that say what they were computed from.
#pragma once

#include <filesystem>
#include <string>

#include "emulator/table.hpp"
#include "io/file_error.hpp"
#include "io/fingerprint.hpp"

namespace wheeltap::emulator {

/// The version of the layout below, kept in the global attribute `table_format_version`.
///   group NAME of a grid: dimensions = factors (coordinate variables with `units` and `scale`) and
///     `response`; variable RESPONSE_NAME(factor…, response) with `units`;
///   group NAME of scattered runs: dimensions `run` and `response`, variables FACTOR(run) with
///     `units`, `scale` and `levels`, variable RESPONSE_NAME(run, response) with `units`;
///   where there are any, variables holdout_{rmse,max_error,spread,q2}(response) and
///     parameter_NAME(rows, columns), and text attributes.
/// A checksum of all of it is the global attribute `table_checksum`.
inline constexpr int kTableFormatVersion = 1;

/// Writes under a temporary name in the same directory and renames, so that `path` is never
/// half-written. Throws FileError (unwritable), and std::invalid_argument for tables whose shapes
/// disagree, that have no values, or names that NetCDF does not take.
void write_table_file(const std::filesystem::path& path, const TableFile& file);

struct TableReadOptions {
  /// When not empty, the attribute "fingerprint" must equal it (FileError: mismatch).
  std::string expected_fingerprint = {};
  bool allow_incomplete = false;  ///< else a table with missing runs is refused
};

/// Everything that the bytes of such a file hold; `name` stands for it in messages. Throws
/// FileError.
[[nodiscard]] TableFile parse_table_file(std::string bytes, const std::filesystem::path& name,
                                         const TableReadOptions& options = {});

/// The same of a file. Throws FileError (missing) besides.
[[nodiscard]] TableFile read_table_file(const std::filesystem::path& path,
                                        const TableReadOptions& options = {});

}  // namespace wheeltap::emulator
