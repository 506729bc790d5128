// Jumps between models, based on the fitted mixtures. A jump keeps the standardised position within
// a mixture component.
#pragma once

#include <memory>

#include "inference/moves/mixture_jump.hpp"

namespace wheeltap::inference {

/// AutoMix (Hastie 2005, section 3.3; Green 2003, section 6.2). The state of model m is allocated
/// to component l of its mixture with probability p(l | z) and standardised, u = L_l⁻¹(z - μ_l). A
/// model m' and a component l' of its mixture are drawn. u is truncated or extended with standard
/// normals to the new dimension, and z' = μ_l' + L_l' u':
///
///   ln ratio = ln [ω_m / (1 - ω_m')] + ln w_l + ln p(l' | z')
///            - ln [ω_m' / (1 - ω_m)] - ln w_l' - ln p(l | z)
///            + Σ_cut ln φ(u) - Σ_filled ln φ(u') + ln |L_l'| - ln |L_l|.
class MixtureTransport : public Move {
 public:
  explicit MixtureTransport(std::shared_ptr<const PilotFit> fit) : fit_(std::move(fit)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::shared_ptr<const PilotFit> fit_;
  std::vector<double> u_, logs_;
};

}  // namespace wheeltap::inference
