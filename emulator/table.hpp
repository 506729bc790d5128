// Tables of model runs and what they were computed from.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// Runs of the model: on a full-factorial grid, or at scattered points.
struct Table {
  std::vector<Factor> factors;  ///< their levels are the grid, or the range of scattered points
  RowMatrix points;             ///< runs × factors where scattered; empty on a grid
  std::string response_name;    ///< e.g. "frequency"
  std::string response_unit;    ///< e.g. "Hz"
  /// runs × responses, rows in the order of `design()`; a row of NaN is a run not done yet.
  RowMatrix values;
  std::vector<HoldoutError> holdout;              ///< one per response, or empty: never measured
  std::map<std::string, std::string> attributes;  ///< e.g. which emulator it is meant for
  std::map<std::string, RowMatrix> parameters;    ///< e.g. lengths of a fitted Gaussian process

  [[nodiscard]] bool is_grid() const { return points.size() == 0; }
  /// The grid, or the scattered points.
  [[nodiscard]] Design design() const;
  [[nodiscard]] Eigen::Index missing_runs() const;
};

/// Throws std::invalid_argument naming the table when its parts do not fit each other, or a name in
/// it is one that table files use themselves.
void check_table(const std::string& name, const Table& table);

/// All that a table file holds.
struct TableFile {
  /// Global text attributes, e.g. "case" (JSON text), "fingerprint", "wheeltap_version", "command".
  std::map<std::string, std::string> attributes;
  /// By group name, e.g. "count_1": the table of runs with one damage.
  std::map<std::string, Table> tables;
};

/// One file from the shards of a design computed in several places: every run that any of them has.
/// Holdout errors, parameters and the tables' attributes are kept only where all shards agree on
/// them; scattered runs are joined, a point found twice being kept once. Throws
/// std::invalid_argument when there are no shards, when their attributes "case" or "fingerprint",
/// their tables, factors or responses differ, or two of them disagree about a run.
[[nodiscard]] TableFile merge(std::span<const TableFile> shards);

}  // namespace wheeltap::emulator
