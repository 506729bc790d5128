// Convergence diagnosis of a run: visits and evidence of each model, and the convergence rules that
// the run violates.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "inference/diagnosis/mixing.hpp"
#include "inference/diagnosis/posterior.hpp"
#include "inference/diagnosis/reason.hpp"
#include "inference/diagnosis/standing.hpp"
#include "inference/search/mode_search.hpp"

namespace wheeltap::inference {

/// Convergence diagnosis of a whole run.
struct Verdict {
  std::vector<ModelStanding> models;    ///< one element per model of the model space
  bool converged = false;               ///< true if and only if `not_established` is empty
  std::vector<Reason> not_established;  ///< most serious first, then by descending probability
  /// Resolution of the mode search, as a prior probability. If the basin of attraction of a
  /// posterior mode has a smaller prior probability, all local optimisations miss the mode with a
  /// probability above 1 %. For n local optimisations in a model, the resolution is 1 - 0.01^(1/n).
  /// `resolution` is the largest of these values over the models; without a search, it is 1. In a
  /// long list, models with only local optimisations and a probability below kLimits.searched_model
  /// are excluded.
  double resolution = 1.0;
  /// Smallest width of a posterior mode for which `resolution` is valid, in standard deviations of
  /// the prior: the largest ModeSearch::spacing of the local optimisations, or 0 if the spacing is
  /// not known. The search may miss a narrower posterior mode even if the prior probability of its
  /// basin of steepest ascent exceeds `resolution` (resolution_of).
  double resolved_width = 0.0;
  /// Number of models searched by local optimisations alone; `resolution` excludes these models
  int glanced = 0;
  /// Number of models that were not evaluated (ModelFindings::passed_over). `resolution` does not
  /// apply to these models.
  int passed_over = 0;
  double rhat_max = std::numeric_limits<double>::quiet_NaN();
  std::string rhat_worst;  ///< the quantity with the largest R-hat
  /// R-hat of all judged quantities: log posterior, counts (or models), `watched`, and parameters
  /// as "model/parameter". `rhat_max` does not include parameters, for which a separate rule
  /// applies.
  std::vector<std::pair<std::string, double>> rhats;
  /// Smallest effective sample size of the component counts, or of the indicators of models
  /// with probabilities above 0.1 %. If counts and indicators hardly change, `ess_model` is
  /// the effective sample size of the log posterior, because a constant has no
  /// autocorrelation.
  double ess_model = 0.0;
  double ess_log_posterior = 0.0;  ///< the smaller of bulk and tail effective sample size

  /// `resolution` for posterior modes of the given width, in standard deviations of the prior
  /// (search_resolution).
  [[nodiscard]] double resolution_of(double width) const {
    return search_resolution(resolution, resolved_width, width);
  }
};

/// Diagnoses a run from its draws and the posterior modes that the searches found
/// (Posterior::found). A run has converged if it satisfies all of the following rules.
/// convergence.hpp defines the limits. The numbers in brackets are the probabilities that a
/// converged run violates the rule by chance.
///
/// - Every chain visited, at β = 1, every model with more than 10 expected effective draws per
///   chain, computed from its evidence (e⁻¹⁰ = 5e-5 per chain). Every other model has draws, or
///   evidence, or a prior weight of 0, or lies outside Occam's window.
/// - Model probabilities from visits and from evidence agree within 4.5 combined errors (7e-6) plus
///   0.005. In every model, ln Z by SMC exceeds ln Z of the draws by at most 4.5 standard errors
///   plus 0.5. The evidence by SMC may be lower, because SMC may miss a posterior mode that the
///   chains visit.
/// - Every chain visited each posterior mode found by the searches for which more than 10 effective
///   draws per chain are expected (5e-5). R-hat of the indicator of this mode is below 1.05, or
///   within the variability expected for the number of effective draws (1e-6).
/// - A draw is outside the fitted mixture if the mixture density at the draw is less than a
///   thousandth of the posterior density. For a model with a probability above 1 %: if more than
///   5 % of its draws are outside, the relative error of this fraction must be at most 0.1, which
///   requires 100 effective visits. Only local moves reach the region outside the mixture. Without
///   this rule, all chains may agree although they have visited only half of the neck of a funnel.
/// - The log posterior and `watched` have R-hat < 1.01 and effective sample sizes above 400.
///   Numbers of components (or model indicators) satisfy the same limits, or the errors of their
///   probabilities are below 0.001.
/// - The parameters of every model with a probability P above 1 % have an R-hat below 1.01, or
///   within the variability expected for the number of draws (1e-6). For components of a kind, the
///   sums of their parameters are checked, because the component numbers are arbitrary labels. The
///   effective sample size of each parameter exceeds 800 P; this limit is at least 20 and at most
///   400. R-hat is checked only with at least 100 draws per chain. For a model probability below
///   5 %, the effective sample size is checked only with at least 400 draws per chain.
/// - With tempered draws, the replicas completed 10 round trips of the ladder.
/// - The run was not stopped early and is not a quick run. For a quick run, the rules for mixtures,
///   chains and parameters are not applied.
///
/// All chains must have the same length. If Posterior::log_weight is not empty, a draw of model m
/// has the weight exp(log_weight_m).
[[nodiscard]] Verdict judge(const Posterior& posterior, const std::vector<Watched>& watched = {});

}  // namespace wheeltap::inference
