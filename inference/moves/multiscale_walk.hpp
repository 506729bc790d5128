// Symmetric random-walk steps of very different lengths, for posteriors whose width varies over the
// parameter space.
#pragma once

#include "inference/moves/random_walk.hpp"

namespace wheeltap::inference {

/// z' = z + f S u, with u ~ N(0, 1) for one uniformly chosen coordinate (probability ½) or u ~
/// N(0, I) for all coordinates (probability ½). S is the scale matrix of the model after warm-up;
/// for one coordinate, S is its standard deviation. ln f is uniform between ln 10⁻³ and ln 3 and
/// independent of the state. The proposal is symmetric, so the ratio is 1. A random walk with one
/// scale is suitable either for the wide part of a funnel (Neal 2003, Annals of Statistics 31:705,
/// section 8) or for its neck. A walk with many scales moves in both parts, but many of its steps
/// are too long or too short.
class MultiscaleWalk : public Move {
 public:
  /// Uses the last block of each model, which contains all coordinates.
  explicit MultiscaleWalk(RandomWalk::Scales scales) : scales_(std::move(scales)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  RandomWalk::Scales scales_;
  std::vector<double> u_;
};

}  // namespace wheeltap::inference
