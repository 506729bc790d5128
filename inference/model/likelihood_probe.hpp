// Measured run time of a likelihood evaluation.
#pragma once

#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Run time of a likelihood evaluation as processor time of one thread [s]. Other processes hardly
/// affect this time.
struct LikelihoodTime {
  double mean = 0.0;    ///< mean over prior draws, the starts of local optimisations
  double middle = 0.0;  ///< median, which a few expensive evaluations hardly change
  long calls = 0;       ///< number of measured evaluations
};

/// Evaluates the likelihood at draws of the prior, in turn for each model that has parameters,
/// during about `seconds`. The likelihood of every model is evaluated at least once, unless this
/// takes more than ten times `seconds`. Draws with zero likelihood are left out of the measured run
/// time if there are other draws, because their evaluation may be unusually fast.
[[nodiscard]] LikelihoodTime probe(const Problem& problem, double seconds);

}  // namespace wheeltap::inference
