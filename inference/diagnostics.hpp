// Has it converged, and how exact is it? Rank-normalised split R-hat, effective sample sizes, Monte
// Carlo standard errors, and the uncertainty of model probabilities.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace wheeltap::inference {

/// Draws of one quantity: `chains[c][i]`, every chain of the same length.
using ChainsOf = std::vector<std::vector<double>>;

/// Rank-normalised split R-hat: the larger of the bulk and the folded one (Vehtari et al. 2021,
/// section 4.1). NaN for fewer than 4 draws a chain; 1 for a constant that agrees in every chain, +∞
/// where the chains are constant at different values.
[[nodiscard]] double rhat(const ChainsOf& draws);
/// Effective sample size of the rank-normalised split draws (ibid., sections 3.2 and 4.3), by Geyer's
/// initial monotone sequence, autocovariances by FFT.
[[nodiscard]] double ess_bulk(const ChainsOf& draws);
/// The smaller of the effective sample sizes of the 5 % and 95 % quantiles (ibid., section 4.3).
[[nodiscard]] double ess_tail(const ChainsOf& draws);
/// Effective sample size of the mean: split, not rank-normalised (right for indicators).
[[nodiscard]] double ess_mean(const ChainsOf& draws);
/// Monte Carlo standard error of the mean, sd / √ess_mean; 0 for a constant.
[[nodiscard]] double mcse_mean(const ChainsOf& draws);
/// Integrated autocorrelation time of the mean, draws / ess_mean.
[[nodiscard]] double iact(const ChainsOf& draws);

/// Posterior of the stationary distribution of the model indicator (Heck et al. 2019): rows of the
/// transition matrix get independent Dirichlet(ε) priors, and each posterior draw of the matrix has
/// a stationary vector.
struct ModelProbabilities {
  std::vector<double> mean;       ///< one a model
  std::vector<double> sd;
  Eigen::MatrixXd transitions;    ///< counts, models × models
  double effective_draws = 0.0;   ///< Dirichlet moment matching, ibid., eq. 9 and following
};
[[nodiscard]] ModelProbabilities stationary_model_probabilities(
    const std::vector<std::vector<int>>& model_chains, int models, std::uint64_t seed,
    int posterior_draws = 1000);

/// Completed trips of an indicator between its lowest and highest visited value, over all chains.
[[nodiscard]] long round_trips(const std::vector<std::vector<int>>& chains, int lowest, int highest);

}  // namespace wheeltap::inference
