// Starting points for long records. The posterior of a long record is thousands of times narrower
// than the prior, so that exploration from the prior is too expensive.
#pragma once

#include <vector>

#include "inference/evidence/laplace.hpp"
#include "inference/options.hpp"
#include "inference/progress_monitor.hpp"

namespace wheeltap::inference {

/// Draws from each model's posterior given the first few thousand samples of the record. Newton
/// steps then track the posterior mode, from the best sample on, as the record grows to its full
/// length. The function returns, for each model, one posterior mode and the number of likelihood
/// evaluations. The evidence is NaN if no posterior mode was found. Requires `problem.shortened`.
[[nodiscard]] std::vector<Laplace> climb_with_record(const Problem& problem, const Options& options,
                                                     ProgressMonitor& monitor);

}  // namespace wheeltap::inference
