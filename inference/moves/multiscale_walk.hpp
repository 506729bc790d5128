// Symmetric steps of all lengths, for posteriors whose width changes from place to place.
#pragma once

#include "inference/moves/random_walk.hpp"

namespace wheeltap::inference {

/// z' = z + f S u: along one coordinate, chosen uniformly, or along all of them, a step each second
/// time, with u ~ N(0, 1) or N(0, I) and S the model's scales as warm-up has left them (of one
/// coordinate its standard deviation). ln f is uniform between ln 10⁻³ and ln 3, chosen without
/// regard to the state: symmetric, so the ratio is 1. A random walk with one scale is right in the
/// mouth of a funnel (Neal 2003, Annals of Statistics 31:705, section 8) or in its neck; one of all
/// scales moves in both, at the price of the steps that are too long or too short.
class MultiscaleWalk : public Move {
 public:
  /// Uses the last block of each model: all its coordinates.
  explicit MultiscaleWalk(RandomWalk::Scales scales) : scales_(std::move(scales)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  RandomWalk::Scales scales_;
  std::vector<double> u_;
};

}  // namespace wheeltap::inference
