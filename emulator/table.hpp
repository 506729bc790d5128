// Tables of model runs and their origin.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// Runs of the model: on a full-factorial grid, or at scattered points.
struct Table {
  std::vector<Factor> factors;  ///< levels of the grid, or range of the scattered points
  RowMatrix points;             ///< runs × factors if scattered; empty for a grid
  std::string response_name;    ///< e.g. "frequency"
  std::string response_unit;    ///< e.g. "Hz"
  /// Runs × responses, rows in the order of `design()`; a row of NaN is a missing run.
  RowMatrix values;
  std::vector<HoldoutError> holdout;              ///< one per response, or empty: not measured
  std::map<std::string, std::string> attributes;  ///< e.g. the emulator that the table belongs to
  std::map<std::string, RowMatrix> parameters;    ///< e.g. lengths of a fitted Gaussian process

  [[nodiscard]] bool is_grid() const { return points.size() == 0; }
  /// The grid, or the scattered points.
  [[nodiscard]] Design design() const;
  [[nodiscard]] Eigen::Index missing_runs() const;
};

/// Throws std::invalid_argument, naming the table, if its parts are inconsistent or a name in it is
/// reserved by the file format.
void check_table(const std::string& name, const Table& table);

/// Content of a table file.
struct TableFile {
  /// Global text attributes, e.g. "case" (JSON text), "fingerprint", "wheeltap_version", "command".
  std::map<std::string, std::string> attributes;
  /// By group name, e.g. "count_1": the table of runs with one damage.
  std::map<std::string, Table> tables;
};

/// Merges the shards of a design that several machines have computed. The result contains every run
/// that any shard contains. Holdout errors, parameters and the tables' attributes are kept only if
/// all shards agree on them. Scattered runs are concatenated without duplicates. Throws
/// std::invalid_argument if there are no shards, if their attributes "case" or "fingerprint", their
/// tables, factors or responses differ, or if two of them have different values of a run.
[[nodiscard]] TableFile merge(std::span<const TableFile> shards);

}  // namespace wheeltap::emulator
