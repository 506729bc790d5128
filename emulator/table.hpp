// Tables of model runs, with attributes that describe their origin.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// A table of model runs on a full-factorial grid, or at scattered points.
struct Table {
  std::vector<Factor> factors;  ///< levels of the grid, or range of the scattered points
  RowMatrix points;             ///< runs × factors for scattered points; empty for a grid
  std::string response_name;    ///< for example "frequency"
  std::string response_unit;    ///< for example "Hz"
  /// Runs × responses, rows in the order of `design()`; a row of NaN marks a missing run.
  RowMatrix values;
  std::vector<HoldoutError> holdout;              ///< hold-out error per response, if measured
  std::map<std::string, std::string> attributes;  ///< for example the emulator to which the table
                                                  ///< belongs
  std::map<std::string, RowMatrix> parameters;    ///< for example correlation lengths of a Gaussian
                                                  ///< process

  [[nodiscard]] bool is_grid() const { return points.size() == 0; }
  /// Returns the points of the grid, or the scattered points.
  [[nodiscard]] Design design() const;
  [[nodiscard]] Eigen::Index missing_runs() const;
};

/// Checks a table. Throws std::invalid_argument, naming the table, if the sizes of its members are
/// inconsistent, or if the table uses a name that the file format reserves.
void check_table(const std::string& name, const Table& table);

/// The content of a table file.
struct TableFile {
  /// Global text attributes, for example "case" (JSON text), "fingerprint", "wheeltap_version",
  /// "command".
  std::map<std::string, std::string> attributes;
  /// Tables by the name of their group, for example "count_1": the table of runs with one damage.
  std::map<std::string, Table> tables;
};

/// Merges the parts (shards) of a design whose runs were made on several machines. The result
/// contains the runs of all shards. Hold-out errors, parameters and attributes of tables are kept
/// only if they are equal in all shards. Runs at scattered points are concatenated without
/// duplicates. Throws std::invalid_argument for an empty list of shards. Throws
/// std::invalid_argument if the attributes "case" or "fingerprint", the tables, the factors or the
/// responses of the shards differ. Throws std::invalid_argument if two shards have different values
/// for the same run.
[[nodiscard]] TableFile merge(std::span<const TableFile> shards);

}  // namespace wheeltap::emulator
