// Diagnosis of a run: visits and evidence of each model, whether the run has converged, and the
// rules that it violates.
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

/// Diagnosis of a whole run.
struct Verdict {
  std::vector<ModelStanding> models;    ///< one per model of the space
  bool converged = false;               ///< true exactly if `not_established` is empty
  std::vector<Reason> not_established;  ///< the most serious first, models in order of probability
  /// Resolution of the mode search: for a mode whose basin of attraction holds a smaller share of
  /// the prior, the probability that all climbs missed it is above 1 %. It is 1 - 0.01^(1/n) for n
  /// climbs, the largest over the models, and 1 without a search. If there are many models, those
  /// below kLimits.searched_model that were only searched by climbs are excluded.
  double resolution = 1.0;
  /// Smallest width of modes for which `resolution` is valid, in standard deviations of the prior:
  /// the largest ModeSearch::spacing of the climbs; 0 if it is not known. A narrower mode may be
  /// missed although its basin of steepest ascent is larger (resolution_of).
  double resolved_width = 0.0;
  int glanced = 0;  ///< models searched by climbs alone, which do not count in `resolution`
  /// Number of models that were not evaluated (ModelFindings::passed_over); they are also excluded
  /// from `resolution`.
  int passed_over = 0;
  double rhat_max = std::numeric_limits<double>::quiet_NaN();
  std::string rhat_worst;  ///< its quantity
  /// R-hat of all judged quantities: log posterior, counts (or models), `watched`, and parameters
  /// as "model/parameter". Parameters have a separate rule and are not included in `rhat_max`.
  std::vector<std::pair<std::string, double>> rhats;
  /// Smallest effective sample size over the counts of the kinds, or over the indicators of the
  /// models above 0.1 %. If counts and indicators hardly change, it is that of the log posterior,
  /// because a constant has no autocorrelation.
  double ess_model = 0.0;
  double ess_log_posterior = 0.0;  ///< the smaller of bulk and tail

  /// `resolution` for modes of this width, in standard deviations of the prior (search_resolution).
  [[nodiscard]] double resolution_of(double width) const {
    return search_resolution(resolution, resolved_width, width);
  }
};

/// Diagnoses a run from its draws and the findings of the searches (Posterior::found). A run has
/// converged if it satisfies all of the following rules. convergence.hpp defines the limits. The
/// numbers in brackets are the probabilities that a converged run violates the rule by chance.
///
/// - Every chain visited, at β = 1, every model whose probability by evidence times the effective
///   draws per chain exceeds 10 (e⁻¹⁰ = 5e-5 per chain). Every other model has draws, or evidence,
///   or a prior weight of 0, or lies outside Occam's window.
/// - Visits and evidence agree within 4.5 combined errors (7e-6) and 0.005. No evidence by SMC
///   exceeds that of the draws by 4.5 errors and half a nat. The evidence by SMC may be lower,
///   because SMC may miss a mode that the chains visit.
/// - Every chain visited each mode that the searches found and whose share of the draws should
///   exceed 10 per chain (5e-5). R-hat of the mode's indicator is below 1.05, or within the scatter
///   of chains with that many effective draws (1e-6).
/// - This rule applies to a model above 1 % if at more than 5 % of its draws the fitted mixture has
///   less than a thousandth of the posterior density. The share of such draws is known to a
///   relative error of 0.1, that is from 100 effective visits. Only local moves reach these draws.
///   In the neck of a funnel, all chains may agree although they have found only half of it.
/// - R-hat < 1.01 and effective sample sizes above 400 of the log posterior and of `watched`; also
///   of counts (or model indicators), unless their probabilities are known to 0.001.
/// - Parameters within every model above 1 % (for components of a kind their sums, because the
///   numbers of components are arbitrary) have an R-hat below 1.01, or within the scatter expected
///   for the number of draws (1e-6). Their effective sample size is above 800 P, at least 20 and at
///   most 400. R-hat is judged from 100 draws per chain, the effective sample size of a model below
///   5 % from 400.
/// - With tempered draws, 10 round trips of the ladder.
/// - The run was not stopped early and is not a quick run. For a quick run, no other rule is
///   applied.
///
/// All chains must have the same length. If Posterior::log_weight is not empty, a draw of model m
/// has the weight exp(log_weight_m).
[[nodiscard]] Verdict judge(const Posterior& posterior, const std::vector<Watched>& watched = {});

}  // namespace wheeltap::inference
