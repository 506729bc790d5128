// What a run may vouch for: of each model, whether it was visited and what its evidence says; and
// of the whole, whether it has converged and, where not, what is not established.
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

/// What was found of a whole run.
struct Verdict {
  std::vector<ModelStanding> models;    ///< one a model of the space
  bool converged = false;               ///< exactly where `not_established` is empty
  std::vector<Reason> not_established;  ///< the gravest first, models in order of probability
  /// A mode that a climb from less than this share of the prior leads to would probably (1 in 100)
  /// not have been seen: 1 - 0.01^(1/n) for n climbs, the largest over the models that count; 1
  /// where nothing was searched. Of many models those below kLimits.searched_model do not count
  /// where they had a glance only.
  double resolution = 1.0;
  /// That holds of modes that are at least so wide, in standard deviations of the prior: the
  /// climbs' largest ModeSearch::spacing; 0: not known. Steepest ascent may lead to narrower ones
  /// from a larger share, and they would still not have been seen (resolution_of).
  double resolved_width = 0.0;
  int glanced = 0;      ///< models that do not count towards it
  int passed_over = 0;  ///< nor these, which were not even glanced at (ModelFindings::passed_over)
  double rhat_max = std::numeric_limits<double>::quiet_NaN();
  std::string rhat_worst;  ///< the quantity that has it
  /// Of all that was judged: the log posterior, counts (or models), `watched`, and parameters as
  /// "model/parameter", which have a rule of their own and no part in `rhat_max`.
  std::vector<std::pair<std::string, double>> rhats;
  /// Smallest over the kinds' counts, or the indicators of the models above 0.1 %; that of the log
  /// posterior where these hardly change, since a constant tells nothing of how often it could
  /// have.
  double ess_model = 0.0;
  double ess_log_posterior = 0.0;  ///< the smaller of bulk and tail

  /// `resolution` of modes so wide, in standard deviations of the prior (search_resolution).
  [[nodiscard]] double resolution_of(double width) const {
    return search_resolution(resolution, resolved_width, width);
  }
};

/// Judges draws and what the searches found (Posterior::found) together. Converged needs all of
/// the following, whose limits stand in convergence.hpp; beside each rule stands how often a
/// healthy run breaks it by chance.
///
/// - Every model whose probability by evidence times the effective draws a chain exceeds 10 was
///   visited at β = 1 by every chain (e⁻¹⁰ = 5e-5 a chain); of every other model something is
///   known: draws, or evidence, or that its prior weight is 0, or that it lies outside Occam's
///   window.
/// - Visits and evidence agree within 4.5 combined errors (7e-6) and 0.005, and no evidence by
///   annealing is above that of the draws by 4.5 errors and half a nat. (Below it may be: annealing
///   that missed a mode is no fault of draws that have it.)
/// - Every mode that the searches found and whose share of the draws should exceed 10 a chain is in
///   every chain (5e-5), and R-hat of its indicator is below 1.05 or within what chains of that
///   many effective draws scatter by (1e-6).
/// - Of models above 1 %, where more than 5 % of the draws lie where the fitted mixture has less
///   than a thousandth of the posterior's density: that share is known to a tenth, by 100 effective
///   visits. Chains come there by small steps alone; of a funnel's neck they may have found half,
///   and agree.
/// - R-hat < 1.01 and effective sample sizes above 400 of the log posterior and `watched`; the same
///   of counts (or models' indicators) where their probabilities are not known to 0.001 anyway.
/// - Parameters within every model above 1 %, components of a kind by their sums since which
///   is which is a label: R-hat below 1.01 or within what so few draws scatter by (1e-6), and an
///   effective sample size above 800 P, at least 20 and at most 400: the parameters of a model that
///   is improbable need not be known as well. R-hat is judged from 100 draws a chain, the effective
///   sample size of a model below 5 % from 400.
/// - Where draws were tempered, 10 round trips of the ladder.
/// - The run was not stopped early, and no mere look: of a look's chains nothing else is judged.
///
/// All chains must be of one length. Where Posterior::log_weight is not empty, a draw of model m
/// counts exp(log_weight_m).
[[nodiscard]] Verdict judge(const Posterior& posterior, const std::vector<Watched>& watched = {});

}  // namespace wheeltap::inference
