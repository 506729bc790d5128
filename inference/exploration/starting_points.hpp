// Starting points on long records. Their posteriors are thousands of times narrower than the
// priors, so that exploration from the prior is too expensive.
#pragma once

#include <vector>

#include "inference/evidence/laplace.hpp"
#include "inference/options.hpp"
#include "inference/progress_monitor.hpp"

namespace wheeltap::inference {

/// Samples each model's posterior given the first few thousand samples of the record. Newton steps
/// then follow the best sample as the record grows to its full length. Returns one mode per model
/// with its likelihood calls; the evidence is NaN if no mode was found. Requires
/// `problem.shortened`.
[[nodiscard]] std::vector<Laplace> climb_with_record(const Problem& problem, const Options& options,
                                                     ProgressMonitor& monitor);

}  // namespace wheeltap::inference
