// A record in windows, each fitted by itself: how far what one of them says holds for another.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "identification/findings/between_windows.hpp"
#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"

namespace wheeltap::identification {

/// What became of the windows under one model.
struct ModelWindows {
  int windows = 0;  ///< of all records together
  int fitted = 0;   ///< windows whose likelihood has a mode with a normal about it
  /// Of each parameter of the model, in its order: none for those of the initial state, and where
  /// fewer than two windows say anything.
  std::vector<std::optional<BetweenWindows>> parameters = {};
  /// Windows in which the likelihood is far from normal along this parameter.
  std::vector<int> rough = {};
  long likelihood_evaluations = 0;
};

/// [first, last) of each window in one record: equal parts of what is scored, but for a sample; all
/// of it where SidCase::windows is 0.
[[nodiscard]] std::vector<std::pair<int, int>> window_bounds(const SidCase& sid_case);

/// The case of one record in which only samples [first, last) of the record are scored. What stands
/// before them, to where the case's own record begins, is integrated: the window's likelihood is
/// its part of the whole record's,
///
///   ln p(r_1 … r_N | θ) = Σ_w ln p(r_w | θ)   (white residuals),
///
/// so that windows ask for nothing of their own, and agree with the whole on where θ is.
[[nodiscard]] SidCase window_case(SidCase sid_case, int first, int last);

/// The hierarchical model of Sedehi, Papadimitriou & Katafygiotis (2019, Mech. Syst. Signal
/// Process. 123:648), each window with parameters of its own:
///
///   z_w ~ N(μ, Σ),   data of w | z_w,
///
/// z the standard normal coordinates of the priors, so that the case's prior is that of μ, and no
/// Σ reaches beyond it. As there, each window's posterior is taken for the normal about its mode
/// (inference/evidence/laplace.hpp), climbed to from `start` (the model's parameters, e.g. the best
/// draw). Each parameter is judged by its own marginal,
///
///   ẑ_w ~ N(μ_i, Σ_ii + s_w²),
///
/// which needs none of Σ's other entries and as few as two windows (hierarchical_posterior.hpp;
/// five or more for intervals to be of use). The window's own prior, N(0, 1), is divided out of
/// ẑ_w and s_w. Several records are windows side by side. How far from normal: the log posterior
/// two standard deviations from the mode, along the regression on the parameter, has to fall by 1
/// to 4 instead of 2.
///
/// Ever longer records have their best fit where the expected score is zero, which is not the mean
/// of what windows find: those that say more count more. The error of the whole record's mode about
/// that comes from the windows' likelihoods there (inference/statistics/grouped_scores.hpp).
[[nodiscard]] ModelWindows fit_windows(const SidProblem& problem, int model,
                                       std::span<const double> start, int threads = 0);

/// Windows that disagree by more than they may (BetweenWindows::scatters), and fits that are not
/// what they are taken for.
[[nodiscard]] std::vector<Remark> window_remarks(const SidProblem& problem, int model,
                                                 const ModelWindows& windows);

}  // namespace wheeltap::identification
