// A second, smaller step after a rejected random-walk step.
#pragma once

#include "inference/moves/random_walk.hpp"

namespace wheeltap::inference {

/// Delayed rejection (Tierney & Mira 1999; Haario et al. 2006, DRAM, section 2.2) on all
/// coordinates of a model. The first proposal is z₁ = z + S u with u ~ N(0, I). If z₁ is rejected,
/// the second proposal is z₂ = z + γ S u₂, accepted with probability
///
///   min{1, π(z₂) q(z₂ → z₁) [1 - α(z₂, z₁)] / ( π(z) q(z → z₁) [1 - α(z, z₁)] )},
///
/// where q is the proposal density of the first stage and α its acceptance probability. S is a
/// scale matrix, one per model, adapted by the method of RandomWalk.
class DelayedRejection : public Kernel {
 public:
  explicit DelayedRejection(RandomWalk::Scales scales)
      : Kernel("delayed rejection"), scales_(std::move(scales)) {}
  Outcome step(State& state, const Step& step) override;
  void save(std::vector<double>& numbers) const override { RandomWalk::save(scales_, numbers); }
  void restore(std::span<const double>& numbers) override { RandomWalk::restore(scales_, numbers); }

 private:
  static constexpr double kShrink = 0.2;  ///< γ

  RandomWalk::Scales scales_;
  State first_, second_;
};

}  // namespace wheeltap::inference
