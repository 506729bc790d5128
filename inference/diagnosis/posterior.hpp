// Result of a run: posterior draws of (model, parameters), findings about each model, and the
// probabilities and Bayes factors that follow:
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

/// Counts of a move after warm-up.
struct MoveStatistics {
  std::string name;
  long proposed = 0;
  long accepted = 0;
};

/// A mode of one model that a search found.
struct FoundMode {
  std::vector<double> x;       ///< physical parameters
  double log_posterior = 0.0;  ///< in standard normal coordinates
  long climbs = 0;             ///< number of climbs that ended there
  double share = 0.0;          ///< share of its model's probability, by importance sampling
  std::vector<double> drawn;   ///< its share of each chain's draws of the model; NaN if none
};

/// Findings about one model besides the draws: searches and evidence.
struct ModelFindings {
  long climbs = 0;       ///< to modes, each started from a draw of the prior
  double spacing = 0.0;  ///< distance between the points that they evaluated (ModeSearch::spacing)
  bool glanced = false;  ///< one of many models, searched by climbs alone
  /// One of very many nested models, not evaluated: all evaluated models one step from it are
  /// outside Occam's window (exploration/occams_window.hpp).
  bool passed_over = false;
  /// No draw of its prior had a finite likelihood: its probability is 0.
  bool impossible = false;
  /// Modes that exceeded the limit of a search, and their share of the model's probability by
  /// Laplace's method.
  long left_out = 0;
  double left_out_share = 0.0;
  ParetoTail pareto{};  ///< tail of the importance weights of `sampled`
  /// Separate modes above the threshold, the largest probability mass first.
  std::vector<FoundMode> modes;
  Evidence annealed = kNoEvidence;  ///< by SMC or the ladder, starting from the prior; NaN: not run
  Evidence sampled = kNoEvidence;   ///< by importance sampling from the final mixture
  Evidence bridged =
      kNoEvidence;  ///< by bridge sampling between its draws and that mixture; NaN: too few draws
  /// Share of the model's draws where the mixture has less than a thousandth of the posterior
  /// density, and its effective sample size. Only local moves reach these draws. NaN as `bridged`.
  double beyond_mixture = std::numeric_limits<double>::quiet_NaN();
  double beyond_mixture_ess = std::numeric_limits<double>::quiet_NaN();
  /// The same share of the SMC draws, without those from which chains return to the mixture; NaN:
  /// not examined.
  double annealed_beyond = std::numeric_limits<double>::quiet_NaN();
  long annealed_draws = 0;  ///< number of SMC draws
};

/// Likelihood calls by purpose; calls of the approximate likelihood if the problem has one.
struct Calls {
  long explore = 0;   ///< finding the posterior from the prior, the sum of the next three
  long search = 0;    ///< climbs to modes, most of them on the first samples of a record
  long anneal = 0;    ///< SMC of each model
  long weigh = 0;     ///< importance sampling from the results of both
  long tune = 0;      ///< fitting the proposals, and a ladder if the draws need one
  long sample = 0;    ///< the draws
  long evidence = 0;  ///< evidence by the mixtures that the draws are compared with
};

/// Decisions of the engine that the options do not state.
enum class Choice {
  restarted_tempered,  ///< the chains disagreed: restarted with parallel tempering throughout
  /// Started near modes of a record's first samples, followed as the record grew.
  started_on_first_samples,
  drawn_by_searches,  ///< stopped before its chains had drawn: draws come from the searches
};

/// Record of a run: moves, likelihood calls, options in effect.
struct RunRecord {
  std::vector<MoveStatistics> moves;
  std::vector<std::vector<long>> jumps_proposed;  ///< models × models, after warm-up
  std::vector<std::vector<long>> jumps_accepted;
  int draws = 0;   ///< draws per chain
  int warmup = 0;  ///< iterations per chain at β = 1 before the first draw
  int thin = 1;
  long warmup_evaluations = 0;
  Calls calls{};
  long likelihood_evaluations = 0;  ///< total, warm-up included
  /// Calls of the full likelihood if the problem has an approximate one, warm-up included;
  /// `likelihood_evaluations` then counts the approximate one.
  long full_evaluations = 0;
  double wall_seconds = 0.0;
  bool stopped_early = false;
  bool quick = false;           ///< Options::quick
  bool tempered_draws = false;  ///< drawn with parallel tempering
  long ladder_round_trips = 0;  ///< from β = 0 to β = 1 and back while drawing, over all chains
  double barrier = 0.0;  ///< Λ of the ladder (Syed et al. 2022), the largest of any chain; 0: none
  long impossible = 0;   ///< likelihood values of NaN or +∞, counted as -∞
  /// Models with a likelihood of zero at every point drawn from their prior: their probability is
  /// 0.
  std::vector<int> impossible_models;
  std::vector<Choice> choices;
};

/// The result of a run. It shares its space and does not refer to the problem.
struct Posterior : RunRecord {
  std::shared_ptr<const ModelSpace> space;
  std::vector<Chain> chains;
  std::vector<ModelFindings> found;  ///< one per model
  /// ln weight of a draw, one per model; empty: equal weights. Not empty if `Options::balance` drew
  /// models more evenly than they are probable.
  std::vector<double> log_weight;
  int dimension = 0;    ///< row length of Chain::theta
  int predictions = 0;  ///< row length of Chain::prediction

  /// Draw i of chain c.
  [[nodiscard]] Draw draw(std::size_t c, std::size_t i) const { return chains[c].draw(i, *space); }
  /// Its row of Chain::theta.
  [[nodiscard]] std::span<const double> theta(std::size_t c, std::size_t i) const {
    const auto width = static_cast<std::size_t>(dimension);
    return {chains[c].theta.data() + i * width, width};
  }
  /// Chain and place of the draw with the largest likelihood, the first of several.
  [[nodiscard]] std::pair<std::size_t, std::size_t> best_draw() const;

  // Queries. Each of the first four judges the whole run (verdict.hpp) and sorts all draws. For
  // repeated queries, call `judge(posterior)` once and use its result. A model is given by index or
  // name; an unknown one throws std::invalid_argument.

  /// P(model | data): the share of its draws, or the probability implied by its evidence if the
  /// draws are not reliable (ModelStanding). 0 with an error of NaN if nothing is known.
  [[nodiscard]] Estimate probability(int model) const;
  [[nodiscard]] Estimate probability(std::string_view model) const;
  /// ln B_ab; value and error are NaN if nothing is known of a or b.
  [[nodiscard]] Estimate log_bayes_factor(int a, int b) const;
  [[nodiscard]] Estimate log_bayes_factor(std::string_view a, std::string_view b) const;
  /// Whether the run converged, and the reasons if it did not; the list is empty exactly if it
  /// converged.
  [[nodiscard]] bool converged() const;
  [[nodiscard]] std::vector<Reason> why_not() const;

  /// All draws of a parameter within a model, one vector per chain (of different lengths), e.g.
  /// draws_of("k", "own springs") or draws_of("location[2]", "2 damages"). Throws
  /// std::invalid_argument, listing the names, if the model has no such parameter.
  [[nodiscard]] ChainsOf draws_of(std::string_view parameter, int model) const;
  [[nodiscard]] ChainsOf draws_of(std::string_view parameter, std::string_view model) const;
  /// 1 for a draw of the model, else 0: all draws of all chains.
  [[nodiscard]] ChainsOf indicator(int model) const;
};

}  // namespace wheeltap::inference
