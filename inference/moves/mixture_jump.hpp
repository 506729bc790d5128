// Independence proposals from normal mixtures fitted to pilot samples.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "inference/mixtures/normal_mixture.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Fits to the pilot samples: for each model, a normalised density q_m(z) that approximates its
/// posterior, and a rough probability ω_m > 0.
struct PilotFit {
  /// Density of each model; null for a model without parameters
  std::vector<std::unique_ptr<NormalMixture>> density;
  std::vector<double> weight;

  /// ln q_m(z); 0 for a model without parameters.
  [[nodiscard]] double log_density(int model, std::span<const double> z) const {
    const auto& q = density[static_cast<std::size_t>(model)];
    return q ? q->log_density(z) : 0.0;
  }
};

/// Draws a model m' ≠ m with probability ω_m' / (1 - ω_m). The contribution of this choice to the
/// acceptance ratio, ln [ω_m / (1 - ω_m')] - ln [ω_m' / (1 - ω_m)], is added to `log_ratio`.
/// Returns -1 if there is no other model.
[[nodiscard]] int propose_model(const PilotFit& fit, int from, base::Random& random,
                                double& log_ratio);

/// Proposes a model m' and draws its parameters from q_m' (the independence form of AutoMix: Hastie
/// 2005, ch. 3; Green 2003). If `between` is true, m' ≠ m is drawn with probability ω_m' / (1 -
/// ω_m); if false, m' = m. In both cases,
///
///   ln ratio = ln [ω_m / (1 - ω_m')] + ln q_m(z) - ln [ω_m' / (1 - ω_m)] - ln q_m'(z').
///
/// q_m' is a density over vectors with components in any order. If the components of a draw are not
/// in order, no proposal is made.
class MixtureJump : public Move {
 public:
  MixtureJump(std::shared_ptr<const PilotFit> fit, bool between)
      : fit_(std::move(fit)), between_(between) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::shared_ptr<const PilotFit> fit_;
  bool between_;
};

}  // namespace wheeltap::inference
