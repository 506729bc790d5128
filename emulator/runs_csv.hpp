// Designs and model runs as CSV text, so that any finite-element program can compute the runs of a
// table.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "emulator/table.hpp"
#include "io/file_error.hpp"

namespace wheeltap::emulator {

/// Reads runs of a model from delimited text (io/tables/delimited_text.hpp). The first line
/// contains the names of the columns, with or without units in brackets ("location [m],reduction,f1
/// [Hz],f2 [Hz]"); every further line is a run. Empty lines are ignored. `factors` names the input
/// columns; the factors of the table have the order of this list. All other columns are responses,
/// in the order of the file, and must have the same unit. A factor without levels gets the range of
/// its column. For a factor with levels, every value must lie in the range of the levels. If a
/// factor and its column both have a unit, the units must agree. The result is a table of scattered
/// runs with the response name `response_name`. `name` is the file's name in messages. Throws
/// FileError (corrupt), with line and column, for a cell that is not a finite number, a row with
/// too few cells, a duplicate name and an unknown factor. Also throws FileError (corrupt) for a
/// value outside the range of its factor, a duplicate point, or a file without runs.
[[nodiscard]] Table parse_runs_csv(std::string bytes, const std::filesystem::path& name,
                                   std::vector<Factor> factors, const std::string& response_name);

/// Reads a file of runs. Throws the exceptions of parse_runs_csv, and FileError (missing).
[[nodiscard]] Table read_runs_csv(const std::filesystem::path& path, std::vector<Factor> factors,
                                  const std::string& response_name);

/// Converts scattered runs to a grid if their points are all combinations of the factors' values,
/// and each combination occurs once. Otherwise returns std::nullopt.
[[nodiscard]] std::optional<Table> as_grid(const Table& scattered);

}  // namespace wheeltap::emulator
