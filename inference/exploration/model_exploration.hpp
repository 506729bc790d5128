// Each model by itself, before models compete: where its posterior is, how much of it there is, and
// draws of it that know all its modes.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/model/model_posterior.hpp"
#include "inference/search/mode_search.hpp"

namespace wheeltap::inference {

struct ExplorationOptions {
  std::uint64_t seed = 1;
  std::vector<std::vector<double>> starts{};  ///< climbed from besides draws of the prior
  long climbs = 0;                            ///< ModeSearchOptions::climbs
  long budget = 100000;                       ///< likelihood calls for climbs
  double effort = 1.0;  ///< of the climbs as a record grows (ModeSearchOptions)
  bool anneal = true;   ///< run sequential Monte Carlo from the prior, as briefly as will do
  /// Climbs alone, for one of very many models: its evidence is Laplace's, taken to be good to a
  /// nat, and its population draws of the normals about its modes.
  bool climbs_only = false;
  bool from_starts = false;  ///< none from the prior, unless those lead nowhere
  int particles = 1200;      ///< of that where it is needed in full, over four replicates
  int rounds = 5;            ///< of importance sampling, at most
  int threads = 0;           ///< 0: as many as the machine has. Never changes a result.
  /// Draws that another method has made, draws × dimension, e.g. tempering over all models.
  Eigen::MatrixXd draws{};
  /// Called, from one thread at a time, with the share done since the last call; returning false
  /// ends the exploration.
  std::function<bool(double share)> progress = nullptr;
  /// Asked between two likelihoods, by any thread; true ends the exploration.
  std::function<bool()> stop = nullptr;
};

/// What exploring spent, in likelihood calls.
struct ExplorationCalls {
  long search = 0;  ///< climbs to modes; most of them on a shortened record where there is one
  long anneal = 0;  ///< sequential Monte Carlo
  long weigh = 0;   ///< importance sampling from the mixture of what was found
  [[nodiscard]] long sum() const { return search + anneal + weigh; }
};

struct ModelExploration {
  std::vector<Mode> modes;     ///< the weightiest first
  std::vector<double> shares;  ///< of the posterior's probability, one a mode
  long climbs = 0;
  double spacing = 0.0;        ///< ModeSearch::spacing of these
  bool glanced = false;        ///< ExplorationOptions::climbs_only: climbed in, not weighed
  bool passed_over = false;    ///< one of very many, outside Occam's window: never looked at
  Eigen::MatrixXd population;  ///< equally weighted draws, dimension × n; none: nothing was found
  Eigen::MatrixXd annealed_draws;  ///< dimension × n; none where annealing was not run or failed
  std::vector<double> annealed_log_posterior;  ///< ln π at each of these
  Evidence annealed = kNoEvidence;             ///< NaN where it was not run or failed
  Evidence sampled = kNoEvidence;  ///< by importance sampling; NaN where nothing was found
  double effective_draws = 0.0;    ///< of the importance sample
  double efficiency = 0.0;         ///< the same, a draw
  ExplorationCalls calls{};

  [[nodiscard]] bool looked_at() const { return calls.sum() > 0; }
  /// The best guess at ln Z so far; -∞ where nothing was found.
  [[nodiscard]] double log_evidence() const;
  /// One mode has 99 % of the probability as far as the climbs know, and a mixture about it weighs
  /// the model well: most of what annealing could tell is known.
  [[nodiscard]] bool settled() const;
};

/// Mode searches and sequential Monte Carlo look for the posterior in two unlike ways: by height,
/// from many places, and by volume, along a path of temperatures. Both feed one normal mixture, to
/// which adaptive multiple importance sampling (Cornuet et al. 2012, Scandinavian J. Statistics
/// 39:798, with Owen & Zhou's balance heuristic) gives the right weights: a mode that one of them
/// missed is there, and one that both found counts once.
///
/// The climbs come first, since they cost the least. Where they settle the matter, a brief
/// annealing looks for what they may have missed: evidence above that of the mixture by more than
/// its error, as the verdict has it, or draws far from every known mode from which a climb leads to
/// another. On a record, where it may lose its way among the first samples, it is cut short after a
/// fixed number of calls, and climbs from where its draws are by then must do. Only where it finds
/// either, or nothing was settled, is the full one paid for.
[[nodiscard]] ModelExploration explore_model(const Problem& problem, int model,
                                             const ExplorationOptions& options);

/// The first half of it: the climbs, and what importance sampling makes of their modes.
[[nodiscard]] ModelExploration survey_model(const Problem& problem, int model,
                                            const ExplorationOptions& options);
/// The second half, of a model that was surveyed: as `how` says, or as far as it takes.
enum class Annealing { as_needed, brief };
void anneal_model(const Problem& problem, int model, const ExplorationOptions& options,
                  Annealing how, ModelExploration& found);

/// The mode among `modes` whose normal gives z the highest density per unit of its peak: the
/// nearest in its own standard deviations. -1 where there is none.
[[nodiscard]] int nearest_mode(const std::vector<Mode>& modes,
                               const std::vector<Eigen::MatrixXd>& precisions,
                               std::span<const double> z);
[[nodiscard]] std::vector<Eigen::MatrixXd> precisions_of(const std::vector<Mode>& modes);

}  // namespace wheeltap::inference
