// Where chains start on long records, whose posteriors are thousands of times narrower than their
// priors: exploring from the prior costs more there than it finds.
#pragma once

#include <vector>

#include "inference/evidence/laplace.hpp"
#include "inference/options.hpp"
#include "inference/progress_monitor.hpp"

namespace wheeltap::inference {

/// Samples of each model's posterior given the first few thousand samples of the record, and Newton
/// steps from the best of them as the record grows to its whole length: a mode a model, with the
/// likelihoods that it took; the evidence is NaN where none was found. `problem` must have
/// `shortened`.
[[nodiscard]] std::vector<Laplace> climb_with_record(const Problem& problem, const Options& options,
                                                     ProgressMonitor& monitor);

}  // namespace wheeltap::inference
