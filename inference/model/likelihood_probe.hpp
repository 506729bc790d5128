// Measured run time of a likelihood evaluation.
#pragma once

#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Run time of a likelihood evaluation, measured as processor time of one thread [s]. Other
/// processes on the machine hardly affect the processor time.
struct LikelihoodTime {
  double mean = 0.0;    ///< mean over draws from the prior, where local optimisations start
  double middle = 0.0;  ///< median, which a few expensive evaluations hardly change
  long calls = 0;       ///< number of measured evaluations
};

/// Evaluates the likelihood at draws of the prior, in turn for each model that has parameters,
/// during about `seconds`. The likelihood of every model is evaluated at least once, unless one
/// evaluation per model takes more than ten times `seconds`. Evaluations that give zero likelihood
/// may be unusually fast; they are excluded from the measured run time if other evaluations exist.
[[nodiscard]] LikelihoodTime probe(const Problem& problem, double seconds);

}  // namespace wheeltap::inference
