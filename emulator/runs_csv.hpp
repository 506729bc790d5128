// Designs and model runs as CSV text, so that any other FE code can make a table.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "emulator/table.hpp"
#include "io/file_error.hpp"

namespace wheeltap::emulator {

/// Runs of a model as delimited text (io/tables/delimited_text.hpp): the first line has the
/// columns' names, each with its unit in brackets or none ("location [m],reduction,f1 [Hz],f2
/// [Hz]"); every further line is a run. Empty lines are accepted. `factors` says which columns are
/// the inputs, in this order; all other columns are the responses, in the file's order, and must
/// have the same unit. A factor without levels gets the range of its column; otherwise every value
/// must lie in its range. A factor's unit, where both give one, must be the column's. Returns
/// scattered runs called `response_name`; `name` stands for the file in messages. Throws FileError:
/// corrupt with line and column for anything that does not fit (a cell that is no finite number, a
/// row too short, a name twice, an unknown factor, a value outside its factor's range, the same
/// point twice, no runs).
[[nodiscard]] Table parse_runs_csv(std::string bytes, const std::filesystem::path& name,
                                   std::vector<Factor> factors, const std::string& response_name);

/// The same of a file. Throws FileError (missing) besides.
[[nodiscard]] Table read_runs_csv(const std::filesystem::path& path, std::vector<Factor> factors,
                                  const std::string& response_name);

/// The same runs as a grid where the points are every combination of their values, once each.
/// std::nullopt otherwise.
[[nodiscard]] std::optional<Table> as_grid(const Table& scattered);

}  // namespace wheeltap::emulator
