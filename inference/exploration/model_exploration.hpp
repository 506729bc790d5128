// Exploration of each model separately: its posterior modes, a first estimate of its evidence, and
// draws that cover all its posterior modes.
#pragma once

#include <algorithm>
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
  /// Starting points of local optimisations in addition to draws of the prior.
  std::vector<std::vector<double>> starts{};
  long climbs = 0;       ///< ModeSearchOptions::climbs
  long budget = 100000;  ///< largest number of likelihood evaluations for local optimisations
  double effort = 1.0;   ///< effort of local optimisations as a record grows (ModeSearchOptions)
  bool anneal = true;    ///< run SMC from the prior, but only as much as needed
  /// If true, run only local optimisations (for a model of a very long list). The evidence is then
  /// computed by Laplace's method, with an assumed error of one nat. The population is drawn from
  /// the normal approximations at the posterior modes.
  bool climbs_only = false;
  /// If true, use prior draws as starting points only if `starts` lead to no posterior mode
  bool from_starts = false;
  /// Total number of particles in four replicates of a full SMC run (up to 20 dimensions)
  int particles = 1200;
  int rounds = 5;             ///< largest number of rounds of importance sampling
  int climbs_from_draws = 8;  ///< largest number of local optimisations from `draws`
  /// Number of threads; 0: all threads of the machine. The results do not depend on this number.
  int threads = 0;
  /// Draws from another sampling method, e.g. tempering over all models; draws × dimension.
  Eigen::MatrixXd draws{};
  /// Callback, called from one thread at a time with the fraction of the work done since the last
  /// call. If the callback returns false, the exploration ends.
  std::function<bool(double share)> progress = nullptr;
  /// Callback, called between two likelihood evaluations by any thread. If the callback returns
  /// true, the exploration ends.
  std::function<bool()> stop = nullptr;
};

/// Models with more dimensions need more SMC particles and more steps of a move.
inline constexpr int kFewDimensions = 20;

/// The number of SMC particles of a model with d dimensions. For d > kFewDimensions, the number is
/// proportional to d, because the proposals need the covariance of the particles.
[[nodiscard]] constexpr int scaled_particles(int particles, int d) {
  return particles / kFewDimensions * std::max(kFewDimensions, d);
}

/// Likelihood evaluations of the exploration.
struct ExplorationCalls {
  long search = 0;  ///< evaluations by local optimisations, for a record mostly on its first
                    ///< samples
  long anneal = 0;  ///< evaluations by sequential Monte Carlo
  long weigh = 0;   ///< evaluations by importance sampling from the mixture fitted to the findings
  [[nodiscard]] long sum() const { return search + anneal + weigh; }
};

struct ModelExploration {
  /// Posterior modes, the mode with the largest probability mass first
  std::vector<Mode> modes;
  std::vector<double> shares;  ///< fraction of the probability mass near each posterior mode
  long climbs = 0;
  double spacing = 0.0;  ///< ModeSearch::spacing of the local optimisations
  long left_out = 0;     ///< ModeSearch::left_out
  double left_out_share = 0.0;
  ParetoTail pareto{};  ///< tail of the importance weights of `sampled`
  /// True if the model was searched by local optimisations alone, without importance sampling
  /// (ExplorationOptions::climbs_only).
  bool glanced = false;
  /// True if the model is outside Occam's window and was not evaluated
  bool passed_over = false;
  /// Equally weighted draws, dimension × n; empty if nothing was found
  Eigen::MatrixXd population;
  /// Draws of SMC, dimension × n; empty if SMC did not run or failed
  Eigen::MatrixXd annealed_draws;
  std::vector<double> annealed_log_posterior;  ///< ln π at each SMC draw
  /// Evidence by SMC; NaN if SMC did not run or failed
  Evidence annealed = kNoEvidence;
  /// Evidence by importance sampling; NaN if no posterior mode was found
  Evidence sampled = kNoEvidence;
  double effective_draws = 0.0;  ///< effective sample size of the importance sampling
  double efficiency = 0.0;       ///< effective_draws divided by the number of draws
  ExplorationCalls calls{};

  [[nodiscard]] bool is_explored() const { return calls.sum() > 0; }
  /// The best estimate of ln Z so far; -∞ if nothing was found.
  [[nodiscard]] double log_evidence() const;
  /// True if one posterior mode has 99 % of the probability mass found by the local optimisations,
  /// and importance sampling from the mixture at this mode is efficient. SMC then hardly improves
  /// the result.
  [[nodiscard]] bool settled() const;
};

/// Mode searches and sequential Monte Carlo (SMC) find the posterior in different ways. Searches
/// maximise the density from many starting points. SMC follows the probability mass along a path of
/// temperatures. One normal mixture is fitted to the results of both methods. Adaptive multiple
/// importance sampling (Cornuet et al. 2012, Scandinavian J. Statistics 39:798, with Owen & Zhou's
/// balance heuristic) gives the mixture's draws the correct weights. A posterior mode that only one
/// method found is thus included. A posterior mode that both methods found is counted once.
///
/// The local optimisations run first, because they need the fewest likelihood evaluations. If the
/// local optimisations determine the posterior (`settled`), a brief SMC run tests whether they
/// missed probability mass. Two results indicate missed probability mass. First, the evidence by
/// SMC is significantly larger than the evidence by the mixture (criterion of the convergence
/// diagnosis). Second, SMC draws lie far from every known mode, and a local optimisation from these
/// draws leads to another posterior mode. For a record, SMC may not reach the posterior of the
/// first samples. SMC then ends after a fixed number of likelihood evaluations, and local
/// optimisations from the current SMC draws follow instead. A full SMC run follows only if the
/// brief run shows missed probability mass, or if the local optimisations did not determine the
/// posterior.
[[nodiscard]] ModelExploration explore_model(const Problem& problem, int model,
                                             const ExplorationOptions& options);

/// First stage of explore_model: local optimisations, and importance sampling around the posterior
/// modes found.
[[nodiscard]] ModelExploration survey_model(const Problem& problem, int model,
                                            const ExplorationOptions& options);
/// Second stage of explore_model, after survey_model: SMC. `how` selects a brief SMC run, or an SMC
/// run that is as long as necessary.
enum class Annealing { as_needed, brief };
void anneal_model(const Problem& problem, int model, const ExplorationOptions& options,
                  Annealing how, ModelExploration& found);

/// Index of the posterior mode nearest to z, if distances are measured in standard deviations of
/// each mode: its normal approximation, divided by its peak value, is the highest at z. The result
/// is -1 if `modes` is empty.
[[nodiscard]] int nearest_mode(const std::vector<Mode>& modes,
                               const std::vector<Eigen::MatrixXd>& precisions,
                               std::span<const double> z);
[[nodiscard]] std::vector<Eigen::MatrixXd> precisions_of(const std::vector<Mode>& modes);

}  // namespace wheeltap::inference
