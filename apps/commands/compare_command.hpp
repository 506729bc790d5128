// wheeltap compare: Bayesian comparison of finished runs on the same data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct CompareOptions {
  std::vector<std::filesystem::path> folders;
  std::vector<double> prior;  ///< prior weight of each folder; empty: equal weights
  bool json = false;
};

/// Computes posterior probabilities of the cases of finished runs from their evidences. The cases
/// may differ in supports, in the unknowns of their baselines or in their force laws. With the
/// evidence Z_m of the most probable model m of a run,
///
///   ln Z = ln Z_m + ln P(m) - ln P(m | data),   P(run | data) ∝ P(run) Z,
///
/// These equations are correct to first order in the errors of P(m | data) and Z_m. The function
/// prints a table, or JSON. Throws Failure: usage for fewer than two folders and for invalid
/// priors; no_input for a folder without a run; bad_input for runs of different kinds, for runs
/// with different or simulated data, and for a run without a known evidence.
void run_compare(const CompareOptions& options);

}  // namespace wheeltap::apps
