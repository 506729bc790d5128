// A needle inside a broad mode: a spike so narrow that a climb steps over it, although steepest
// ascent, a path without steps, leads to it from a large share of the prior.
#pragma once

#include <vector>

#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {

struct NeedleProblem {
  HardProblem hard;
  /// Diameter of the region where the needle is the higher of the two, in standard deviations of
  /// the prior: what a climb may step over.
  double width = 0.0;
  /// Needle and broad mode have one centre: the climbs' own goal.
  bool concentric = false;
};

/// Model 1 is half a normal of width .1 and half a needle, in a box of one to three dimensions;
/// model 0 has no parameters and as much evidence.
[[nodiscard]] const std::vector<NeedleProblem>& needle_problems();

}  // namespace wheeltap::inference
