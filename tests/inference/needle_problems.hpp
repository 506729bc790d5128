// A needle inside a broad mode: a spike so narrow that a climb steps over it, although steepest
// ascent, a continuous path, leads to it from a large share of the prior.
#pragma once

#include <vector>

#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {

struct NeedleProblem {
  HardProblem hard;
  /// Diameter of the region where the needle is higher, in standard deviations of the prior: a
  /// climb may step over it.
  double width = 0.0;
  /// Needle and broad mode have the same centre, where the climbs end.
  bool concentric = false;
};

/// Model 1 is half a normal of width .1 and half a needle, in a box of one to three dimensions;
/// model 0 has no parameters and equal evidence.
[[nodiscard]] const std::vector<NeedleProblem>& needle_problems();

}  // namespace wheeltap::inference
