// Convergence criteria and stopping rule: all limits are defined here.
#pragma once

#include <cstddef>

#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference {

/// The limits of R-hat and effective sample size are those of Vehtari et al. (2021, Bayesian
/// Analysis 16:667). The others are Wheeltap's; verdict.hpp states the false-alarm rate of each.
struct ConvergenceLimits {
  double rhat = 1.01;        ///< upper limit
  double ess = 400.0;        ///< lower limit, all chains together
  double ess_within = 20.0;  ///< the same for the parameters of the least probable model judged
  /// The same for the tails of parameters, as a share of the limit for their bulk.
  double ess_tail_share = 0.5;
  /// Above it, chains are in different places or modes have different shares.
  double rhat_apart = 1.05;
  double known = 0.001;          ///< error of a probability that is negligible
  double worth_knowing = 0.004;  ///< error of a probability that is small enough to stop
  double expected_visits = 10.0;  ///< effective visits expected; none would have probability e⁻¹⁰
  double sigmas = 4.5;   ///< least significant difference, in errors: false-alarm rate 7e-6
  double chance = 1e-6;  ///< false-alarm rate of disagreement between chains
  double slack_probability = 0.005;  ///< difference of probabilities that is never significant
  double slack_nats = 0.5;
  double probable_model = 0.05;
  double judged_model = 0.01;     ///< probability above which a model's parameters are judged
  double searched_model = 0.001;  ///< probability above which a model needs a full search
  double judged_mode = 0.01;      ///< share of the rarer side above which chains must agree on it
  /// Ratio of posterior density to mixture density above which a draw is outside the mixture; the
  /// share of such draws above which they are judged; and the effective visits required there,
  /// which give that share to a relative error of 0.1.
  double beyond_mixture = 1000.0, beyond_share = 0.05, beyond_visits = 100.0;
  /// Difference between the SMC draws' share outside the mixture and the chains' above which it is
  /// judged, in probability; and the number of SMC draws that count as one independent draw.
  double annealed_share = 0.02, annealed_draws_an_effective = 2.0;
  std::size_t fewest_draws = 100;  ///< per chain within a model, to judge R-hat
  std::size_t fewest_for_ess = 400;
  long round_trips = 10;  ///< on the ladder used for the draws
};
inline constexpr ConvergenceLimits kLimits{};

/// True if the run may stop: no violated rule, and the error of every model's share of the draws is
/// at most 0.004 (0.001 if the draws are `balanced` between models).
[[nodiscard]] bool may_stop(const Posterior& posterior, bool balanced);

/// The share of SMC draws outside the model's mixture less that of the chains' draws. 0 if it is
/// negative or unknown, or if the chains visited that region often enough to estimate the share
/// better.
[[nodiscard]] double annealed_excess(const ModelFindings& found);

/// True if that excess is above `share` and significant: for a Poisson count k, 2√k is nearly
/// normal with variance 1 (Anscombe 1948, Biometrika 35:246).
[[nodiscard]] bool lacks_annealed(const ModelFindings& found,
                                  double share = kLimits.annealed_share);

/// True if longer chains would suffice; false if R-hat of the log posterior or of a model is so
/// large that the chains are in different places.
[[nodiscard]] bool chains_agree(const Posterior& posterior);

}  // namespace wheeltap::inference
