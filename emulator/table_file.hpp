// Tables of model runs in NetCDF-4 files. A file contains several tables, each with its factors,
// units and hold-out errors, and attributes that give the origin of the tables.
#pragma once

#include <filesystem>
#include <string>

#include "emulator/table.hpp"
#include "io/file_error.hpp"
#include "io/fingerprint.hpp"

namespace wheeltap::emulator {

/// Version of the following layout, stored in the global attribute `table_format_version`.
///   group NAME of a grid: dimensions = factors (coordinate variables with `units` and `scale`) and
///     `response`; variable RESPONSE_NAME(factor…, response) with `units`;
///   group NAME of scattered runs: dimensions `run` and `response`, variables FACTOR(run) with
///     `units`, `scale` and `levels`, variable RESPONSE_NAME(run, response) with `units`;
///   optional variables holdout_{rmse,max_error,spread,q2}(response) and
///     parameter_NAME(rows, columns), and text attributes.
/// The global attribute `table_checksum` is a checksum of the whole content.
inline constexpr int kTableFormatVersion = 1;

/// Writes a table file. The function writes a temporary file in the same directory and renames this
/// file, so that the file at `path` is always complete. Throws FileError (unwritable), and
/// std::invalid_argument for tables with inconsistent sizes, without values, or with names that
/// NetCDF does not accept.
void write_table_file(const std::filesystem::path& path, const TableFile& file);

struct TableReadOptions {
  /// The expected value of the attribute "fingerprint"; empty: any value. For another value,
  /// reading throws FileError (mismatch).
  std::string expected_fingerprint = {};
  bool allow_incomplete = false;  ///< false: reading rejects a table with missing runs
};

/// Reads a table file from its bytes; `name` is the file's name in messages. Throws FileError.
[[nodiscard]] TableFile parse_table_file(std::string bytes, const std::filesystem::path& name,
                                         const TableReadOptions& options = {});

/// Reads a table file. Throws FileError like parse_table_file, and FileError (missing) if the file
/// does not exist.
[[nodiscard]] TableFile read_table_file(const std::filesystem::path& path,
                                        const TableReadOptions& options = {});

}  // namespace wheeltap::emulator
