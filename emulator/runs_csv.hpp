// Designs and model runs as CSV text, so that any finite-element program can compute the runs of a
// table.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "emulator/table.hpp"
#include "io/file_error.hpp"
#include "io/tables/columns.hpp"

namespace wheeltap::emulator {

/// The response columns of a CSV file of model runs. A column name is the common name of all
/// responses, followed by the response number: "f1", "f2", … or "frequency[1]", "frequency[2]", ….
struct ResponseColumns {
  std::string name;  ///< name of the responses in the table
  /// Factor by which the numbers of a column are multiplied; empty for a unit that cannot be
  /// converted. If `factor` is not set, all columns must have the same unit.
  std::function<std::optional<double>(const io::Column&)> factor = {};
  std::string unit = {};   ///< unit of the converted numbers; used with `factor`
  std::string units = {};  ///< units that `factor` converts, for messages
};

/// Reads runs of a model from delimited text (io/tables/delimited_text.hpp). The first line
/// contains the names of the columns, with or without units in brackets ("location [m],reduction,f1
/// [Hz],f2 [Hz]"); every further line is a run. Empty lines are ignored. `factors` names the input
/// columns and gives the order of the factors in the table. All other columns are responses; the
/// numbers in the column names give the order of the responses in the table. A factor without
/// levels gets the range of its column. For a factor with levels, every value must lie in the range
/// of the levels. If a factor and its column both have a unit, the units must agree. The result is
/// a table of runs at scattered points. `name` is the file's name in messages.
///
/// Throws FileError (corrupt), with line and column, for a cell that is not a finite number, a row
/// with too few cells, a duplicate name and an unknown factor. Also throws FileError (corrupt) for
/// a response without a number, with a name that differs from that of other responses, or with a
/// unit that cannot be converted. The response numbers must be 1, 2, …, n. Also throws FileError
/// (corrupt) for a value outside the range of its factor, a duplicate point, or a file without
/// runs.
[[nodiscard]] Table parse_runs_csv(std::string bytes, const std::filesystem::path& name,
                                   std::vector<Factor> factors, const ResponseColumns& responses);

/// Reads a file of runs. Throws the exceptions of parse_runs_csv, and FileError (missing).
[[nodiscard]] Table read_runs_csv(const std::filesystem::path& path, std::vector<Factor> factors,
                                  const ResponseColumns& responses);

/// Converts runs at scattered points to a grid if the points contain each combination of the
/// factors' values exactly once. For any other points, returns std::nullopt.
[[nodiscard]] std::optional<Table> as_grid(const Table& scattered);

}  // namespace wheeltap::emulator
