// wheeltap compare: which of several finished runs' cases explains the data that they share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct CompareOptions {
  std::vector<std::filesystem::path> folders;
  std::vector<double> prior;  ///< one a folder; empty: all alike
  bool json = false;
};

/// Posterior probabilities of the cases of finished runs, by their evidences: structures with other
/// supports, baselines with other unknowns, records with other laws. With m the most probable model
/// of a run,
///
///   ln Z = ln Z_m + ln P(m) - ln P(m | data),   P(run | data) ∝ P(run) Z,
///
/// to first order in the errors of both. Prints a table, or JSON. Throws Failure: usage for fewer
/// than two folders and priors that are none; no_input for a folder without a run; bad_input for
/// runs of other kinds or other data, data that each case simulated by itself, and runs whose
/// evidence is not known.
void run_compare(const CompareOptions& options);

}  // namespace wheeltap::apps
