// Convergence criteria and stopping rule: all limits are defined here.
#pragma once

#include <cstddef>

#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference {

/// The limits of R-hat and effective sample size follow Vehtari et al. (2021, Bayesian Analysis
/// 16:667). The other limits are specific to Wheeltap; verdict.hpp states the false-alarm rate of
/// each limit.
struct ConvergenceLimits {
  double rhat = 1.01;        ///< upper limit of R-hat
  double ess = 400.0;        ///< lower limit of the effective sample size of all chains together
  double ess_within = 20.0;  ///< required effective sample size of parameters, even if P is small
  /// For parameters: ratio of the lower limit of the tail effective sample size to that of the bulk
  /// effective sample size.
  double ess_tail_share = 0.5;
  /// If R-hat exceeds this limit, the chains are in different regions or disagree on the
  /// probabilities of posterior modes.
  double rhat_apart = 1.05;
  double known = 0.001;  ///< negligible error of a model probability
  /// Largest error of a model probability at which the run may stop
  double worth_knowing = 0.004;
  /// Expected number of effective draws above which a chain without draws is a fault (false-alarm
  /// rate: e⁻¹⁰)
  double expected_visits = 10.0;
  /// Smallest significant difference of two estimates, in standard errors (false-alarm rate: 7e-6)
  double sigmas = 4.5;
  double chance = 1e-6;  ///< false-alarm rate of the tests for disagreement between chains
  /// Largest difference of two probabilities that is always negligible
  double slack_probability = 0.005;
  double slack_nats = 0.5;
  double probable_model = 0.05;
  /// Model probability above which the convergence of the model's parameters is judged
  double judged_model = 0.01;
  double searched_model = 0.001;  ///< model probability above which a full search is required
  /// If the probability P of a posterior mode and 1 - P exceed this limit, the chains must agree on
  /// P
  double judged_mode = 0.01;
  /// Three limits for draws outside the fitted mixture. A draw is outside if the ratio of posterior
  /// density to mixture density is above `beyond_mixture`. If the fraction of draws outside exceeds
  /// `beyond_share`, the number of independent visits to the region outside must be at least
  /// `beyond_visits`. The relative error of the fraction is then 0.1.
  double beyond_mixture = 1000.0, beyond_share = 0.05, beyond_visits = 100.0;
  /// `annealed_share` is the limit of annealed_excess: the fraction of SMC draws outside the
  /// mixture minus the fraction of chain draws outside the mixture. `annealed_draws_an_effective`
  /// is the number of SMC draws that count as one independent draw.
  double annealed_share = 0.02, annealed_draws_an_effective = 2.0;
  /// Smallest number of draws of a model per chain for which R-hat is judged
  std::size_t fewest_draws = 100;
  std::size_t fewest_for_ess = 400;
  long round_trips = 10;  ///< required round trips of replicas on the ladder used for the draws
};
inline constexpr ConvergenceLimits kLimits{};

/// True if the run may stop: it violates no rule, and the error of each model's fraction of draws
/// is at most 0.004 (0.001 if `balanced`: all models are then visited about equally).
[[nodiscard]] bool may_stop(const Posterior& posterior, bool balanced);

/// The fraction of SMC draws outside the model's mixture minus the fraction of chain draws outside
/// the mixture. The result is 0 if the difference is negative or unknown. The result is also 0 if
/// the chains visited the region outside the mixture often enough (kLimits.beyond_visits).
[[nodiscard]] double annealed_excess(const ModelFindings& found);

/// True if the excess (annealed_excess) is above `share` and significant. The test treats 2√k of a
/// Poisson count k as normal with variance 1 (Anscombe 1948, Biometrika 35:246).
[[nodiscard]] bool lacks_annealed(const ModelFindings& found,
                                  double share = kLimits.annealed_share);

/// False if R-hat of the log posterior or of a model indicator shows that the chains are in
/// different regions; longer chains do not help in this case.
[[nodiscard]] bool chains_agree(const Posterior& posterior);

}  // namespace wheeltap::inference
