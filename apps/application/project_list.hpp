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

/// Largest number of folders and files that list_projects examines.
inline constexpr int kMostEntries = 20'000;
inline constexpr int kDeepestFolder = 8;

/// Returns the folder of the results of a case: "NAME-results" beside NAME.json.
[[nodiscard]] std::filesystem::path results_of(const std::filesystem::path& case_path);

/// Returns {folder, truncated, cases, results, records, drawings}. A case is a JSON file with one
/// of `kinds`. Its state is draft (the case violates the schema), ready, running, interrupted (a
/// checkpoint exists), changed (the results belong to an earlier version of the case), or the state
/// of its results. The state of results is converged, not-converged, done (no convergence to check)
/// or alarm. A result is a folder with summary.json. A record is a file with the extension of a
/// measured file. A drawing is a .dxf file. Hidden files and symbolic links are omitted.
[[nodiscard]] Report list_projects(const AppFolder& folder, const std::vector<std::string>& kinds,
                                   const RunQueue& runs);

}  // namespace wheeltap::apps
