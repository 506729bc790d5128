// Reflections: the moves that symmetric structures need.
#pragma once

#include "inference/move.hpp"

namespace wheeltap::inference {

/// Reflects every component of every kind that has a reflection (`whole`: the mirror image of the
/// state), or one component chosen uniformly, in its centre: x → 2 c - x. An involution with
/// |dx'/dx| = 1, so with respect to dz
///
///   ln ratio = Σ ln |dz'/dz| = Σ [ ln p(x') - ln φ(z') - ln p(x) + ln φ(z) ]
///
/// over the reflected coordinates, from |dz/dx| = p(x) / φ(z). A mirror image outside the prior's
/// support is no proposal.
class Mirror : public Move {
 public:
  Mirror(std::vector<Reflection> reflections, bool whole)
      : reflections_(std::move(reflections)), whole_(whole) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::vector<Reflection> reflections_;
  bool whole_;
};

}  // namespace wheeltap::inference
