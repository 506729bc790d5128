// Random walk with the covariance of the mixture component nearest to the state.
#pragma once

#include <memory>
#include <vector>

#include "inference/moves/mixture_jump.hpp"

namespace wheeltap::inference {

/// z' = z + f (2.38/√d) L_k u, with u ~ N(0, I) and ln f uniform between ln 10⁻² and 0. k is a
/// component of the model's fitted mixture, chosen by its responsibility for z (Craiu, Rosenthal &
/// Yang 2009, JASA 104:1454; Bai, Craiu & Di Narzo 2011, J. Comput. Graph. Stat. 20:63). Given f,
///
///   ln ratio = ln Σ_k r_k(z') A_k - ln Σ_k r_k(z) A_k,
///   A_k = exp(-½ d |L_k⁻¹ (z' - z)|² / (2.38 f)²) / |L_k|,
///   r_k(z) ∝ w_k / |L_k| · (1 + |L_k⁻¹ (z - μ_k)|²)^{-(d+1)/2}.
///
/// The responsibilities have Cauchy tails, so that the nearest component is chosen even outside the
/// mixture. No single covariance fits a thin curved ridge. The steps of this walk follow the
/// curvature of the ridge. The steps also reach regions outside the mixture, so that the next
/// fitted mixture covers them.
class RegionalWalk : public Move {
 public:
  explicit RegionalWalk(std::shared_ptr<const PilotFit> fit) : fit_(std::move(fit)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::shared_ptr<const PilotFit> fit_;
  std::vector<double> from_, to_;  ///< L_k⁻¹ (z - μ_k), component after component
  std::vector<double> r_from_, r_to_, terms_;
};

}  // namespace wheeltap::inference
