// Result of a run: posterior draws of (model, parameters), findings about each model, and the
// resulting model probabilities and Bayes factors:
//
//   P(m | data) ∝ P(m) Z_m,   B_ab = Z_a / Z_b = [P(a | data) / P(b | data)] / [P(a) / P(b)].
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "inference/chains/chain.hpp"
#include "inference/diagnosis/reason.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/model/model_posterior.hpp"
#include "inference/model/model_space.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "inference/statistics/estimate.hpp"

namespace wheeltap::inference {

/// Numbers of proposals and acceptances of an MCMC move after warm-up.
struct MoveStatistics {
  std::string name;
  long proposed = 0;
  long accepted = 0;
};

/// A posterior mode of one model, found by the mode search.
struct FoundMode {
  std::vector<double> x;       ///< physical parameters
  double log_posterior = 0.0;  ///< log posterior density in standard normal coordinates
  long climbs = 0;             ///< number of local optimisations that ended at this posterior mode
  /// Fraction of the model's probability mass near this posterior mode, by importance sampling
  double share = 0.0;
  /// Fraction of the model's draws near this posterior mode, one per chain; NaN: no draws
  std::vector<double> drawn;
};

/// Results for one model in addition to its draws: posterior modes and evidence.
struct ModelFindings {
  long climbs = 0;  ///< number of local optimisations, each started from a draw of the prior
  /// Mean distance between the evaluated points of the optimisations (ModeSearch::spacing)
  double spacing = 0.0;
  bool glanced = false;  ///< true: searched by local optimisations alone (in a long list of models)
  /// True if this model of a long nested list was not evaluated. All evaluated
  /// models that differ by one step from this model are then outside Occam's
  /// window (exploration/occams_window.hpp).
  bool passed_over = false;
  /// True if no draw from the model's prior had a positive likelihood; the model's probability is
  /// then 0.
  bool impossible = false;
  /// Number of posterior modes that the search found but did not keep, because their number is
  /// limited; and the fraction of the model's probability mass at these modes (Laplace's method).
  long left_out = 0;
  double left_out_share = 0.0;
  ParetoTail pareto{};  ///< tail of the importance weights of `sampled`
  /// Separate posterior modes with at least 0.1 % of the model's probability mass, in order of
  /// descending mass.
  std::vector<FoundMode> modes;
  Evidence annealed = kNoEvidence;  ///< evidence by SMC or tempering from the prior; NaN if not run
  Evidence sampled = kNoEvidence;   ///< evidence by importance sampling from the final mixture
  Evidence bridged =
      /// Evidence by bridge sampling between the model's draws and its mixture. NaN if the model
      /// has too few draws.
      kNoEvidence;
  /// A draw is outside the mixture if the mixture density is below a thousandth of the posterior
  /// density there. The two values are the fraction of the model's draws outside the mixture, and
  /// the effective sample size of this fraction. Only local moves reach the region outside the
  /// mixture. Both values are NaN if `bridged` is NaN.
  double beyond_mixture = std::numeric_limits<double>::quiet_NaN();
  double beyond_mixture_ess = std::numeric_limits<double>::quiet_NaN();
  /// Fraction of the SMC draws that lie outside the mixture and from which chains do not return to
  /// the mixture; NaN if not examined.
  double annealed_beyond = std::numeric_limits<double>::quiet_NaN();
  long annealed_draws = 0;  ///< number of SMC draws
};

/// Number of likelihood evaluations of each stage. If the problem has an approximate likelihood,
/// the evaluations of the approximation are counted instead.
struct Calls {
  long explore = 0;   ///< exploration from the prior: `search` + `anneal` + `weigh`
  long search = 0;    ///< local optimisations, mostly on the first samples of a record
  long anneal = 0;    ///< SMC of each model
  long weigh = 0;     ///< importance sampling from the results of search and SMC
  long tune = 0;      ///< fit of the proposals, and the ladder of tempered draws if any
  long sample = 0;    ///< evaluations for the draws
  long evidence = 0;  ///< evaluations for the evidence from the mixtures, for comparison with the
                      ///< draws
};

/// Decisions that the engine made because no option prescribed them.
enum class Choice {
  /// The chains disagreed; the run restarted with parallel tempering in all stages
  restarted_tempered,
  /// The mode search used the first samples of a record, then tracked each posterior mode as more
  /// samples were added. The chains started near the resulting posterior modes.
  started_on_first_samples,
  /// The run was stopped before each chain had 100 draws; the draws come from the mode searches
  drawn_by_searches,
};

/// Statistics of a run: moves, likelihood evaluations, and the options that were used.
struct RunRecord {
  std::vector<MoveStatistics> moves;
  std::vector<std::vector<long>> jumps_proposed;  ///< proposed jumps after warm-up, models × models
  std::vector<std::vector<long>> jumps_accepted;
  int draws = 0;   ///< draws per chain
  int warmup = 0;  ///< iterations per chain at β = 1 before the first draw
  int thin = 1;
  long warmup_evaluations = 0;
  Calls calls{};
  long likelihood_evaluations = 0;  ///< total number of likelihood evaluations, warm-up included
  /// Number of evaluations of the full likelihood if the problem has an approximate likelihood,
  /// warm-up included. `likelihood_evaluations` then counts the approximate likelihood.
  long full_evaluations = 0;
  double wall_seconds = 0.0;
  bool stopped_early = false;
  bool quick = false;           ///< Options::quick
  bool tempered_draws = false;  ///< true if the draws were made with parallel tempering
  /// Round trips from β = 0 to β = 1 and back during the draws, over all chains
  long ladder_round_trips = 0;
  /// Communication barrier Λ (Syed et al. 2022), the largest of any chain; 0: no temperature ladder
  double barrier = 0.0;
  long impossible = 0;  ///< number of likelihood values of NaN or +∞, which count as -∞
  /// Models whose likelihood is zero at every draw from the prior; their probability is 0.
  std::vector<int> impossible_models;
  std::vector<Choice> choices;
};

/// The result of a run. A Posterior shares ownership of the model space and does not refer to the
/// problem.
struct Posterior : RunRecord {
  std::shared_ptr<const ModelSpace> space;
  std::vector<Chain> chains;
  std::vector<ModelFindings> found;  ///< one per model
  /// Log weight of a draw, for each model; empty if all weights are equal. With `Options::balance`,
  /// the chains visit improbable models more often than their probabilities imply; the weights
  /// correct for this.
  std::vector<double> log_weight;
  int dimension = 0;    ///< row length of Chain::theta
  int predictions = 0;  ///< row length of Chain::prediction

  /// Draw i of chain c.
  [[nodiscard]] Draw draw(std::size_t c, std::size_t i) const { return chains[c].draw(i, *space); }
  /// The parameters of draw i of chain c: its row of Chain::theta.
  [[nodiscard]] std::span<const double> theta(std::size_t c, std::size_t i) const {
    const auto width = static_cast<std::size_t>(dimension);
    return {chains[c].theta.data() + i * width, width};
  }
  /// Chain and index of the draw with the largest likelihood. If several draws have the largest
  /// likelihood, the first of these draws is returned.
  [[nodiscard]] std::pair<std::size_t, std::size_t> best_draw() const;

  // Queries. Each of the first four functions diagnoses the whole run (verdict.hpp) and sorts all
  // draws. For repeated queries, call `judge(posterior)` once and use its result. A model is given
  // by index or name; an unknown index or name throws std::invalid_argument.

  /// P(model | data): the fraction of draws in the model, or the probability implied by its
  /// evidence if the draws are not reliable (ModelStanding). If neither is known, the probability
  /// is 0 and the error is NaN.
  [[nodiscard]] Estimate probability(int model) const;
  [[nodiscard]] Estimate probability(std::string_view model) const;
  /// ln of the Bayes factor B_ab of models a and b. Value and error are NaN if a or b has neither
  /// draws nor evidence.
  [[nodiscard]] Estimate log_bayes_factor(int a, int b) const;
  [[nodiscard]] Estimate log_bayes_factor(std::string_view a, std::string_view b) const;
  /// True if the run converged. `not_established` lists the reasons why a run did not converge; the
  /// list is empty if and only if the run converged.
  [[nodiscard]] bool converged() const;
  [[nodiscard]] std::vector<Reason> why_not() const;

  /// All draws of a parameter within a model, one vector per chain (of different lengths), e.g.
  /// draws_of("k", "own springs") or draws_of("location[2]", "2 damages"). Throws
  /// std::invalid_argument, listing the names, if the model has no such parameter.
  [[nodiscard]] ChainsOf draws_of(std::string_view parameter, int model) const;
  [[nodiscard]] ChainsOf draws_of(std::string_view parameter, std::string_view model) const;
  /// Indicator of a model for all draws of all chains: 1 for a draw of the model, otherwise 0.
  [[nodiscard]] ChainsOf indicator(int model) const;
};

}  // namespace wheeltap::inference
