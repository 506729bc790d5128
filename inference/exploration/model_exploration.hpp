// Exploration of each model separately: its modes, a first estimate of its evidence, and draws that
// cover all its modes.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/model/model_posterior.hpp"
#include "inference/search/mode_search.hpp"

namespace wheeltap::inference {

struct ExplorationOptions {
  std::uint64_t seed = 1;
  /// Starts of climbs in addition to draws of the prior.
  std::vector<std::vector<double>> starts{};
  long climbs = 0;       ///< ModeSearchOptions::climbs
  long budget = 100000;  ///< likelihood calls for climbs
  double effort = 1.0;   ///< effort of climbs as a record grows (ModeSearchOptions)
  bool anneal = true;    ///< run SMC from the prior, as briefly as sufficient
  /// Run climbs only, for one of very many models. The evidence is then Laplace's, assumed to be
  /// good to a nat, and the population is drawn from the normals about the modes.
  bool climbs_only = false;
  bool from_starts = false;  ///< no climbs from prior draws, unless `starts` lead to no mode
  int particles = 1200;      ///< of SMC at full length, over four replicates
  int rounds = 5;            ///< of importance sampling, upper limit
  int threads = 0;           ///< 0: as many as the machine has. Never changes a result.
  /// Draws of another method, draws × dimension, e.g. tempering over all models.
  Eigen::MatrixXd draws{};
  /// Called from one thread at a time with the share of the work done since the last call;
  /// returning false ends the exploration.
  std::function<bool(double share)> progress = nullptr;
  /// Called between two likelihoods by any thread; returning true ends the exploration.
  std::function<bool()> stop = nullptr;
};

/// Likelihood calls of the exploration.
struct ExplorationCalls {
  long search = 0;  ///< climbs to modes; most of them on a shortened record if there is one
  long anneal = 0;  ///< sequential Monte Carlo
  long weigh = 0;   ///< importance sampling from the mixture fitted to the findings
  [[nodiscard]] long sum() const { return search + anneal + weigh; }
};

struct ModelExploration {
  std::vector<Mode> modes;     ///< the largest probability mass first
  std::vector<double> shares;  ///< probability of each mode
  long climbs = 0;
  double spacing = 0.0;  ///< ModeSearch::spacing of these climbs
  long left_out = 0;     ///< ModeSearch::left_out
  double left_out_share = 0.0;
  ParetoTail pareto{};  ///< tail of the importance weights of `sampled`
  /// ExplorationOptions::climbs_only: searched by climbs, no importance sampling.
  bool glanced = false;
  bool passed_over = false;    ///< one of very many, outside Occam's window: not evaluated
  Eigen::MatrixXd population;  ///< equally weighted draws, dimension × n; empty: nothing was found
  Eigen::MatrixXd annealed_draws;  ///< dimension × n; empty if SMC did not run or failed
  std::vector<double> annealed_log_posterior;  ///< ln π at each of these draws
  Evidence annealed = kNoEvidence;             ///< NaN if SMC did not run or failed
  Evidence sampled = kNoEvidence;              ///< by importance sampling; NaN if nothing was found
  double effective_draws = 0.0;                ///< effective size of the importance sample
  double efficiency = 0.0;                     ///< effective_draws divided by the draws
  ExplorationCalls calls{};

  [[nodiscard]] bool is_explored() const { return calls.sum() > 0; }
  /// The best estimate of ln Z so far; -∞ if nothing was found.
  [[nodiscard]] double log_evidence() const;
  /// Whether one mode has 99 % of the probability found by the climbs and importance sampling from
  /// the mixture about it is efficient. SMC then adds little.
  [[nodiscard]] bool settled() const;
};

/// Mode searches and sequential Monte Carlo (SMC) find the posterior in different ways: searches by
/// density, from many starting points; SMC by probability mass, along a path of temperatures. Both
/// feed one normal mixture. Adaptive multiple importance sampling (Cornuet et al. 2012,
/// Scandinavian J. Statistics 39:798, with Owen & Zhou's balance heuristic) gives its draws the
/// correct weights. A mode that one method missed is thus present, and a mode that both found
/// counts once.
///
/// The climbs come first, since they cost least. If they settle the model, a brief SMC run looks
/// for probability mass that they missed. Either its evidence exceeds that of the mixture
/// significantly, as in the verdict, or some draws lie far from every known mode and a climb from
/// them leads to another one. On a record, SMC may get lost among the first samples; it then ends
/// after a fixed number of calls, and climbs from its current draws replace it. Full SMC runs only
/// if the brief run found something or the climbs settled nothing.
[[nodiscard]] ModelExploration explore_model(const Problem& problem, int model,
                                             const ExplorationOptions& options);

/// The first part: climbs, and importance sampling about their modes.
[[nodiscard]] ModelExploration survey_model(const Problem& problem, int model,
                                            const ExplorationOptions& options);
/// The second part, for a model after survey_model: SMC, brief only or as long as needed
/// (`how`).
enum class Annealing { as_needed, brief };
void anneal_model(const Problem& problem, int model, const ExplorationOptions& options,
                  Annealing how, ModelExploration& found);

/// Index of the mode whose normal gives z the highest density relative to its peak: the nearest in
/// units of its standard deviations. -1 if there is none.
[[nodiscard]] int nearest_mode(const std::vector<Mode>& modes,
                               const std::vector<Eigen::MatrixXd>& precisions,
                               std::span<const double> z);
[[nodiscard]] std::vector<Eigen::MatrixXd> precisions_of(const std::vector<Mode>& modes);

}  // namespace wheeltap::inference
