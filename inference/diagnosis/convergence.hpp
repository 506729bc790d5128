// When a run may stop, and what convergence asks for: the one place where its limits stand.
#pragma once

#include <cstddef>

#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference {

/// Limits on R-hat and effective sample sizes are those of Vehtari et al. (2021, Bayesian
/// Analysis 16:667); the
/// others are ours, with the false alarms that follow from them beside verdict.hpp's rules.
struct ConvergenceLimits {
  double rhat = 1.01;             ///< below it
  double ess = 400.0;             ///< above it, of all chains together
  double ess_within = 20.0;       ///< the same of parameters of the least probable model judged
  double rhat_apart = 1.05;       ///< from here on chains are in different places, or modes unlike
  double known = 0.001;           ///< an error of a probability that nobody cares about
  double worth_knowing = 0.004;   ///< an error of a probability that is good enough to stop
  double expected_visits = 10.0;  ///< effective ones, from which none is no chance: e⁻¹⁰
  double sigmas = 4.5;            ///< of a difference that is no chance: 7e-6
  double chance = 1e-6;           ///< of a scatter between chains that is called disagreement
  double slack_probability = 0.005;  ///< a difference that is none, whatever its error
  double slack_nats = 0.5;
  double probable_model = 0.05;
  double judged_model = 0.01;     ///< probability from which a model's parameters are judged
  double searched_model = 0.001;  ///< from which a glance at a model does not do
  double judged_mode = 0.01;      ///< share of the rarer side from which chains must agree on it
  /// Ratio of the densities of posterior and mixture from which a draw is beyond the mixture; the
  /// share of such draws that is judged; and how many effective visits there they must be, so that
  /// the share is known to a tenth.
  double beyond_mixture = 1000.0, beyond_share = 0.05, beyond_visits = 100.0;
  /// By so much of the probability must more of annealing's draws than of the chains' be there to
  /// be judged, and so many of its draws count as one independent one.
  double annealed_share = 0.02, annealed_draws_an_effective = 2.0;
  std::size_t fewest_draws = 100;  ///< of a chain within a model, for R-hat to be judged
  std::size_t fewest_for_ess = 400;
  long round_trips = 10;  ///< of a ladder that the draws are made with
};
inline constexpr ConvergenceLimits kLimits{};

/// Good enough to stop: nothing that the verdict misses, and the share of every model among the
/// draws known to 0.004, to 0.001 where models are drawn `balanced`.
[[nodiscard]] bool may_stop(const Posterior& posterior, bool balanced);

/// By how much more of annealing's draws of a model than of the chains' lie beyond its mixture;
/// 0 where they are fewer, unknown, or the chains were there often enough to know better.
[[nodiscard]] double annealed_excess(const ModelFindings& found);

/// Whether that exceeds `share`, and is no chance: of a count k that is Poisson's, 2√k is normal
/// with variance 1 (Anscombe 1948, Biometrika 35:246).
[[nodiscard]] bool lacks_annealed(const ModelFindings& found,
                                  double share = kLimits.annealed_share);

/// Whether longer chains would do: an R-hat far from 1, of the log posterior or of a model, says
/// that they are in different places.
[[nodiscard]] bool chains_agree(const Posterior& posterior);

}  // namespace wheeltap::inference
