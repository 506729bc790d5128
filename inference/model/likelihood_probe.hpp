// Measured run time of a likelihood.
#pragma once

#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Run time of a likelihood as processor time of one thread [s], which other processes hardly
/// affect.
struct LikelihoodTime {
  double mean = 0.0;    ///< over draws of the prior, as at the start of climbs
  double middle = 0.0;  ///< the median, which a few expensive evaluations do not affect
  long calls = 0;       ///< measured
};

/// Evaluates the likelihood at draws of the prior of all models with parameters in turn, for about
/// `seconds`. Every model is evaluated at least once, unless that takes more than ten times as
/// long. Impossible draws, whose evaluation may be fast, are excluded if possible draws exist.
[[nodiscard]] LikelihoodTime probe(const Problem& problem, double seconds);

}  // namespace wheeltap::inference
