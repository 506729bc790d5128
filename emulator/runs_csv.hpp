// Designs and model runs as CSV text, so that any FE program can compute a table.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "emulator/table.hpp"
#include "io/file_error.hpp"

namespace wheeltap::emulator {

/// Reads runs of a model from delimited text (io/tables/delimited_text.hpp). The first line has the
/// columns' names, each with its unit in brackets or without ("location [m],reduction,f1 [Hz],f2
/// [Hz]"); every further line is a run. Empty lines are ignored. `factors` names the input columns,
/// in this order. All other columns are the responses, in the file's order, and must have the same
/// unit. A factor without levels gets the range of its column; otherwise every value must lie in
/// its range. If a factor and its column both have a unit, they must agree. Returns scattered runs
/// called `response_name`; `name` is the file's name in messages. Throws FileError (corrupt), with
/// line and column, for a cell that is not a finite number, a row that is too short, a duplicate
/// name, an unknown factor, a value outside its factor's range, a duplicate point, or no runs.
[[nodiscard]] Table parse_runs_csv(std::string bytes, const std::filesystem::path& name,
                                   std::vector<Factor> factors, const std::string& response_name);

/// Reads a file of runs. Throws the exceptions of parse_runs_csv, and FileError (missing).
[[nodiscard]] Table read_runs_csv(const std::filesystem::path& path, std::vector<Factor> factors,
                                  const std::string& response_name);

/// Converts scattered runs to a grid if their points are all combinations of the values, each once;
/// otherwise returns std::nullopt.
[[nodiscard]] std::optional<Table> as_grid(const Table& scattered);

}  // namespace wheeltap::emulator
