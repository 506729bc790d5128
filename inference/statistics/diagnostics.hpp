// Convergence diagnostics: rank-normalised split R-hat, effective sample sizes, Monte Carlo
// standard errors, and the uncertainty of model probabilities.
#pragma once

#include <cstdint>
#include <vector>
#include "base/eigen.hpp"

namespace wheeltap::inference {

/// Draws of one quantity: `chains[c][i]`, all chains of the same length. The functions below return
/// NaN if the chains have fewer than 4 draws or if a draw is NaN. These functions throw
/// std::invalid_argument if the lengths differ or there is no chain.
using ChainsOf = std::vector<std::vector<double>>;

/// Rank-normalised split R-hat: the larger of bulk R-hat and folded R-hat (Vehtari et al. 2021,
/// section 4.1). The result is 1 if all draws are equal, and +∞ if each chain is constant but the
/// chains differ.
[[nodiscard]] double rhat(const ChainsOf& draws);
/// Effective sample size of the N rank-normalised split draws (Vehtari et al. 2021, sections 3.2
/// and 4.3), by Geyer's initial monotone sequence. The result is at most N log10 N, a limit that
/// only antithetic chains reach. For a constant, the result is N.
[[nodiscard]] double ess_bulk(const ChainsOf& draws);
/// The smaller of the effective sample sizes of the 5 % and 95 % quantiles (Vehtari et al. 2021,
/// section 4.3).
[[nodiscard]] double ess_tail(const ChainsOf& draws);
/// Effective sample size of the mean, from split chains without rank normalisation (valid for
/// indicators).
[[nodiscard]] double ess_mean(const ChainsOf& draws);
/// Monte Carlo standard error of the mean, sd / √ess_mean; 0 for a constant.
[[nodiscard]] double mcse_mean(const ChainsOf& draws);
/// Monte Carlo standard error of the standard deviation s, √(var(d²) / ess_mean(d²)) / (2 s) with
/// the deviations d from the mean (delta method); 0 for a constant. The error is large if a few
/// draws far from the mean determine s. Rank-normalised R-hat does not detect such draws.
[[nodiscard]] double mcse_sd(const ChainsOf& draws);
/// Mean over the draws of all chains, whose lengths may differ; NaN without draws.
[[nodiscard]] double mean(const ChainsOf& draws);

/// R-hat, effective sample sizes and errors of one quantity, computed in one pass over the data
/// with one sort.
struct Convergence {
  double rhat, ess_bulk, ess_tail, ess_mean, mcse_mean;
};
[[nodiscard]] Convergence convergence(const ChainsOf& draws);

/// Posterior of the stationary distribution of the model indicator (Heck et al. 2019, Statistics
/// and Computing 29:631). The rows of the transition matrix of the visited models have independent
/// Dirichlet(ε, …, ε) priors, ε = 1 / (number of visited models). Each posterior draw of the matrix
/// gives a draw of the stationary distribution. The method assumes that the indicator is a Markov
/// chain, which holds approximately.
struct ModelProbabilities {
  /// Posterior mean of each model probability; 0 for a model never visited
  std::vector<double> mean;
  std::vector<double> sd;       ///< 0 for a model never visited
  Eigen::MatrixXd transitions;  ///< number of transitions between models, models × models
  /// Size of an independent sample that would give the same uncertainty: the mass of the Dirichlet
  /// distribution with the same mean and total variance, minus the mass of the prior. The size is
  /// infinite if only one model was visited.
  double effective_draws = 0.0;
};
/// Throws std::invalid_argument for an index outside [0, models) or fewer than 1 posterior draw.
[[nodiscard]] ModelProbabilities stationary_model_probabilities(
    const std::vector<std::vector<int>>& model_chains, int models, std::uint64_t seed,
    int posterior_draws = 1000);

/// Number of completed round trips of an index (lowest → highest → lowest, or the reverse) in all
/// chains; 0 if lowest = highest.
[[nodiscard]] long round_trips(const std::vector<std::vector<int>>& chains, int lowest,
                               int highest);

}  // namespace wheeltap::inference
