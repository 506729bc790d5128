// The results of a batch: one row per case.
#pragma once

#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace wheeltap::apps {

inline constexpr const char* kBatchTable = "batch.csv";

struct BatchRow {
  std::string name;     ///< name of the case and its folder
  std::string kind{};   ///< kind of the case; empty if the case does not state its kind
  int exit = 0;         ///< exit code of the run, or 128 + the number of the signal that ended it
  std::string model{};  ///< the most probable model, "7 modes" for a modal case, otherwise empty
  std::optional<double> probability{};  ///< probability of this model
  std::optional<bool> converged{};
  double seconds = 0.0;  ///< wall time [s] of the run, summed over its sessions
  std::string error{};   ///< one-line error message if `exit` is not 0
  std::string path{};    ///< path of the case, relative to the batch folder
};

/// Packs and unpacks a row for ranks (base/parcel.hpp).
template <class Parcel, class Row>
requires std::same_as<std::remove_const_t<Row>, BatchRow>
void carry(Parcel& parcel, Row& row) {
  parcel(row.name, row.kind, row.exit, row.model, row.probability, row.converged, row.seconds,
         row.error, row.path);
}

/// Fills the results of a successful run from summary.json in `folder`; a sweep has converged if
/// all its rows have converged.
void take_from_summary(const std::filesystem::path& folder, BatchRow& row);

/// Returns true if the run in `folder` was stopped before its end.
[[nodiscard]] bool stopped_early(const std::filesystem::path& folder);

/// Returns CSV (RFC 4180) with one line per existing row and the columns case, kind, exit, model,
/// probability, converged, wall_seconds, folder, error and path. An apostrophe precedes cells that
/// a spreadsheet would evaluate as formulas: cells that begin with = + - or @ and are not numbers.
[[nodiscard]] std::string batch_csv(const std::vector<std::optional<BatchRow>>& rows);

/// Returns the table as JSON text: a list of objects with the columns as keys. An empty cell is
/// null.
[[nodiscard]] std::string batch_json(const std::vector<std::optional<BatchRow>>& rows);

/// Returns a line without a line break: "[ 3/10] name  2 damages, P = 97 %  converged  12 s".
[[nodiscard]] std::string batch_line(const BatchRow& row, std::size_t done, std::size_t all);

}  // namespace wheeltap::apps
