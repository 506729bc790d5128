// The results of a batch: one row a case.
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
  std::string name;     ///< of the case and its folder
  std::string kind{};   ///< empty where the case does not say
  int exit = 0;         ///< of its run; 128 + the signal where one ended it
  std::string model{};  ///< the most probable one; of a modal case "7 modes"; else empty
  std::optional<double> probability{};  ///< of that model
  std::optional<bool> converged{};
  double seconds = 0.0;  ///< wall time of the run itself, however many sessions it took
  std::string error{};   ///< one line, where exit is not 0
  std::string path{};    ///< of the case, from the batch's folder
};

/// For ranks (base/parcel.hpp), both ways.
template <class Parcel, class Row>
requires std::same_as<std::remove_const_t<Row>, BatchRow>
void carry(Parcel& parcel, Row& row) {
  parcel(row.name, row.kind, row.exit, row.model, row.probability, row.converged, row.seconds,
         row.error, row.path);
}

/// What summary.json in `folder` says of a run that ended well; of a sweep, whether all its rows
/// converged.
void take_from_summary(const std::filesystem::path& folder, BatchRow& row);

/// Whether the run in `folder` was stopped before its end.
[[nodiscard]] bool stopped_early(const std::filesystem::path& folder);

/// Columns case, kind, exit, model, probability, converged, wall_seconds, folder, error, path (RFC
/// 4180), one line for each row that there is. A cell that a spreadsheet would compute, for it
/// begins with = + - or @ and is no number, has an apostrophe before it.
[[nodiscard]] std::string batch_csv(const std::vector<std::optional<BatchRow>>& rows);

/// The same as JSON text: a list of objects with the columns as keys; null where a cell is empty.
[[nodiscard]] std::string batch_json(const std::vector<std::optional<BatchRow>>& rows);

/// "[ 3/10] name  2 damages, P = 97 %  converged  12 s": a line without its end.
[[nodiscard]] std::string batch_line(const BatchRow& row, std::size_t done, std::size_t all);

}  // namespace wheeltap::apps
