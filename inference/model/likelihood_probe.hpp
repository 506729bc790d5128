// Measured run time of a likelihood.
#pragma once

#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Processor time of one thread [s], on which other processes have little effect.
struct LikelihoodTime {
  double mean = 0.0;    ///< over draws of the prior, as at the start of climbs
  double middle = 0.0;  ///< the median: rare expensive ones do not count
  long calls = 0;       ///< measured
};

/// Measures likelihoods at draws of the prior, all models with parameters in turn, for about
/// `seconds`; at least one per model, unless that takes ten times as long. Impossible draws, which
/// may cost little, do not count if others are possible.
[[nodiscard]] LikelihoodTime probe(const Problem& problem, double seconds);

}  // namespace wheeltap::inference
