// What a run found, in the two sentences that people read first.
#pragma once

#include <string>

#include "apps/summary.hpp"

namespace wheeltap::apps {

struct Answer {
  std::string caution;   ///< empty, or why the rest cannot be trusted yet
  std::string headline;  ///< how many, or which model, with its probability
  std::string detail;    ///< where and how bad, with 95 % intervals; may be empty
};

/// Reads summary.json of a `damage` or `sid` run. A count (a model) is "most likely" from a
/// probability of 0.6; below, the run is undecided and all with 10 % or more are named. A location
/// whose 95 % interval covers more than a quarter of the beam is not called located.
[[nodiscard]] Answer answer(const Report& summary);

}  // namespace wheeltap::apps
