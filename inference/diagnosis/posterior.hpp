// What a run returns: draws of (model, parameters) from the posterior, what is known of each model
// beside them, and the questions they answer:
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
#include "inference/model/model_posterior.hpp"
#include "inference/model/model_space.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "inference/statistics/estimate.hpp"

namespace wheeltap::inference {

/// How often a move was tried and accepted after warm-up.
struct MoveStatistics {
  std::string name;
  long proposed = 0;
  long accepted = 0;
};

/// A mode of one model that a search found.
struct FoundMode {
  std::vector<double> x;       ///< physical parameters
  double log_posterior = 0.0;  ///< in standard normal coordinates
  long climbs = 0;             ///< that ended there
  double share = 0.0;          ///< of its model's probability, by importance sampling
  std::vector<double> drawn;   ///< its share of each chain's draws of the model; NaN where none
};

/// What is known of one model beside the draws: searches and evidence.
struct ModelFindings {
  long climbs = 0;       ///< to modes, each from a draw of the prior
  double spacing = 0.0;  ///< of the points that these evaluated (ModeSearch::spacing)
  bool glanced = false;  ///< one of many models, of which this alone is known
  /// One of very many nested models, never looked at: all that were looked at of those one step
  /// from it are below Occam's window (stages/occams_window.hpp).
  bool passed_over = false;
  std::vector<FoundMode> modes;  ///< separate ones that matter, the weightiest first
  Evidence annealed =
      kNoEvidence;  ///< by sequential Monte Carlo or the ladder, from the prior; NaN: not run
  Evidence sampled = kNoEvidence;  ///< by importance sampling from the final mixture
  Evidence bridged =
      kNoEvidence;  ///< by bridge sampling between its draws and that mixture; NaN: too few draws
  /// Share of its draws at which that mixture has less than a thousandth of the posterior's
  /// density, and the effective sample size of it: there the steps of a walk alone lead. NaN as
  /// `bridged`.
  double beyond_mixture = std::numeric_limits<double>::quiet_NaN();
  double beyond_mixture_ess = std::numeric_limits<double>::quiet_NaN();
  /// The same share of the draws of annealing, without those that walk home; NaN: none were looked
  /// at.
  double annealed_beyond = std::numeric_limits<double>::quiet_NaN();
  long annealed_draws = 0;  ///< how many there are
};

/// Likelihood calls, by what they were spent on; of a stand-in where there is one.
struct Calls {
  long explore = 0;   ///< from the prior to where the posterior is; of these:
  long search = 0;    ///<   climbs to modes, most of them on the first samples of a record
  long anneal = 0;    ///<   each model by sequential Monte Carlo
  long weigh = 0;     ///<   importance sampling from what both found
  long tune = 0;      ///< fitting the proposals, and a ladder where the draws need one
  long sample = 0;    ///< the draws
  long evidence = 0;  ///< of the mixtures that the draws are compared with
};

/// What the engine chose to do, beyond what its options say.
enum class Choice {
  restarted_tempered,  ///< the chains disagreed: once more, with parallel tempering throughout
  started_on_first_samples,  ///< near modes found on a long record's start, followed as it grew
  drawn_by_searches,         ///< stopped before its chains had drawn: draws of what searches found
};

/// How the draws of a run were made.
struct RunRecord {
  std::vector<MoveStatistics> moves;
  std::vector<std::vector<long>> jumps_proposed;  ///< models × models, after warm-up
  std::vector<std::vector<long>> jumps_accepted;
  int draws = 0;   ///< kept a chain
  int warmup = 0;  ///< iterations a chain at β = 1 before the first draw
  int thin = 1;
  long warmup_evaluations = 0;
  Calls calls{};
  long likelihood_evaluations = 0;  ///< all of them, warm-up included
  /// Of the likelihood proper where the problem has a stand-in, warm-up included; those above are
  /// then the stand-in's.
  long full_evaluations = 0;
  double wall_seconds = 0.0;
  bool stopped_early = false;
  bool quick = false;           ///< Options::quick
  bool tempered_draws = false;  ///< the draws were made with parallel tempering
  long ladder_round_trips =
      0;                 ///< between β = 0 and β = 1 and back, while drawing, over all chains
  double barrier = 0.0;  ///< Λ of the ladder (Syed et al. 2022), the largest of any chain; 0: none
  long impossible = 0;   ///< likelihoods that were NaN or +∞ and counted as -∞
  std::vector<Choice> choices;
};

/// All that a run found. It shares its space and refers to nothing else: the problem may be gone.
struct Posterior : RunRecord {
  std::shared_ptr<const ModelSpace> space;
  std::vector<Chain> chains;
  std::vector<ModelFindings> found;  ///< one a model
  /// ln of what a draw of each model counts, one a model; empty: all count the same. Not empty
  /// where `Options::balance` drew models more evenly than they are probable.
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

  // The questions. Each of the first four judges the whole run (verdict.hpp), which sorts all its
  // draws: who asks often keeps `judge(posterior)` and asks that. Models are asked for by index or
  // by name; std::invalid_argument is thrown for one that is not there.

  /// P(model | data): the share of its draws, or, where those cannot say, what its evidence implies
  /// (ModelStanding). Where nothing is known: 0, its error NaN.
  [[nodiscard]] Estimate probability(int model) const;
  [[nodiscard]] Estimate probability(std::string_view model) const;
  /// ln B_ab; both NaN where nothing is known of a or b.
  [[nodiscard]] Estimate log_bayes_factor(int a, int b) const;
  [[nodiscard]] Estimate log_bayes_factor(std::string_view a, std::string_view b) const;
  /// Whether the run may be relied on, and where not, why not: empty exactly where it may.
  [[nodiscard]] bool converged() const;
  [[nodiscard]] std::vector<Reason> why_not() const;

  /// A parameter within a model, e.g. draws_of("k", "own springs") or draws_of("location[2]",
  /// "2 damages"): every draw of that model, a vector a chain, of as many as each has. Throws
  /// std::invalid_argument, listing the names, where the model has no such parameter.
  [[nodiscard]] ChainsOf draws_of(std::string_view parameter, int model) const;
  [[nodiscard]] ChainsOf draws_of(std::string_view parameter, std::string_view model) const;
  /// 1 where a draw is of the model, 0 where it is not: all draws of all chains.
  [[nodiscard]] ChainsOf indicator(int model) const;
};

}  // namespace wheeltap::inference
