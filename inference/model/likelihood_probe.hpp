// Measured run time of a likelihood.
#pragma once

#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Processor time of one thread [s], so that what else the machine does counts little.
struct LikelihoodTime {
  double mean = 0.0;    ///< over draws of the prior, as climbs begin
  double middle = 0.0;  ///< the median: rare expensive ones do not count
  long calls = 0;       ///< measured
};

/// Likelihoods at draws of the prior, all models with parameters in turn, for about so many
/// seconds; at least one of each model, unless that takes ten times as long. Impossible draws,
/// which may cost little, do not count where others are possible.
[[nodiscard]] LikelihoodTime probe(const Problem& problem, double seconds);

}  // namespace wheeltap::inference
