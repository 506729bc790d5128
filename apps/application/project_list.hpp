// The content of the folder of the application: cases with their states, results, records.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/application/app_folder.hpp"
#include "apps/application/run_queue.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// Largest number of folders and files that a list visits.
inline constexpr int kMostEntries = 20'000;
inline constexpr int kDeepestFolder = 8;

/// Returns the folder of the results of a case: "NAME-results" beside NAME.json.
[[nodiscard]] std::filesystem::path results_of(const std::filesystem::path& case_path);

/// Returns {folder, truncated, cases, results, records, drawings}. A case is a JSON object with one
/// of the kinds. Its state is draft (its keys do not satisfy the schema), ready, running,
/// interrupted (a checkpoint exists), changed (results of an earlier text), or the state of its
/// results: converged, not-converged, done (a kind without convergence) or alarm. A result is a
/// folder with summary.json. A record is another file with the extension of a measured file. A
/// drawing is a .dxf file. Hidden files and symbolic links are omitted.
[[nodiscard]] Report list_projects(const AppFolder& folder, const std::vector<std::string>& kinds,
                                   const RunQueue& runs);

}  // namespace wheeltap::apps
