// Separate fits of the windows of a record, and the agreement of the estimates between windows.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "identification/findings/between_windows.hpp"
#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// The fits of all windows under one model.
struct ModelWindows {
  int windows = 0;  ///< number of windows, over all records
  int fitted = 0;   ///< number of windows with a normal approximation at a posterior mode
  /// One entry per parameter of the model; empty for initial states, and if fewer than two windows
  /// have information about the parameter.
  std::vector<std::optional<BetweenWindows>> parameters = {};
  /// Number of windows, per parameter, in which the likelihood is far from normal as a function of
  /// the parameter.
  std::vector<int> rough = {};
  long likelihood_evaluations = 0;
};

/// Samples [first, last) of each window in one record. Windows divide the scored samples; their
/// lengths differ by at most one sample. If SidCase::windows is 0, one window has all samples.
[[nodiscard]] std::vector<std::pair<int, int>> window_bounds(const SidCase& sid_case);

/// Restricts the likelihood of one record to the window [first, last). The motion is integrated
/// from the start of the record, but samples before the window do not enter the likelihood. For
/// white residuals, the likelihood of the whole record is the product of the likelihoods of the
/// windows:
///
///   ln p(r_1 … r_N | θ) = Σ_w ln p(r_w | θ)   (white residuals),
///
/// Windows therefore need no additional parameters, and the estimates from the windows are
/// consistent with the estimate from the whole record.
[[nodiscard]] SidCase window_case(SidCase sid_case, int first, int last);

/// Fits the hierarchical model of Sedehi, Papadimitriou & Katafygiotis (2019, Mech. Syst. Signal
/// Process. 123:648), with separate parameters for each window:
///
///   z_w ~ N(μ, Σ),   data of w | z_w.
///
/// z are the standard normal coordinates of the priors. The prior of μ is the prior of the case. Σ
/// cannot be wider than this prior. As in Sedehi et al., the posterior of each window is replaced
/// by its normal approximation at the posterior mode (inference/evidence/laplace.hpp). The search
/// for this mode begins at `start` (e.g. the best draw). Each parameter i is analysed separately,
/// by its marginal distribution
///
///   ẑ_w ~ N(μ_i, Σ_ii + s_w²).
///
/// The marginal distribution does not depend on the other entries of Σ
/// (hierarchical_posterior.hpp). This analysis needs at least two windows; for credible intervals
/// of useful width, five or more. The estimates ẑ_w and s_w no longer contain the window's prior
/// N(0, 1). Windows of further records are used like those of the first record. Let a parameter
/// differ from the posterior mode by two standard deviations, with the other parameters at their
/// conditional means. A normal log posterior then decreases by 2. If the decrease is below 1 or
/// above 4, the window counts as far from normal.
///
/// As records become longer, the best fit approaches the point at which the expected score is zero.
/// This limit differs from the mean of the estimates of the windows, because windows with more
/// information have more weight. The scores of the windows give the error of the whole record's
/// posterior mode relative to the limit (inference/statistics/grouped_scores.hpp).
[[nodiscard]] ModelWindows fit_windows(const SidProblem& problem, int model,
                                       std::span<const double> start, int threads = 0);

/// Remarks on windows whose estimates differ by more than their credible intervals allow
/// (BetweenWindows::scatters), on failed fits and on inaccurate normal approximations.
[[nodiscard]] std::vector<Remark> window_remarks(const SidProblem& problem, int model,
                                                 const ModelWindows& windows);

}  // namespace wheeltap::identification
