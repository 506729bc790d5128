// Importance sampling: the evidence as the mean weight of draws from a proposal.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "inference/mixtures/normal_mixture.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

struct ImportanceOptions {
  std::uint64_t seed = 1;
  int draws = 20000;
  int threads = 0;  ///< number of threads; 0: all threads of the machine. The results do not depend
                    ///< on this number.
};

struct ImportanceSampling {
  Evidence evidence;
  double effective_draws = 0.0;  ///< effective sample size, (Σw)² / Σw²
  double pareto_k = 0.0;         ///< Pareto shape of the weights (pareto_shape)
};

/// Estimates Z = E_q[π/q] from draws of the proposal q. An example of q is a mixture fitted to
/// pilot draws, with a defensive component. The standard error is sd(w) / (mean(w) √n). Warns that
/// the error is unreliable if the Pareto shape exceeds 0.7 or there are fewer than 100 effective
/// draws.
[[nodiscard]] ImportanceSampling importance_sampling(const Problem& problem, int model,
                                                     const NormalMixture& proposal,
                                                     const ImportanceOptions& options);

/// ln π(z) - ln q(z) of n draws from q. The number of likelihood evaluations is added to
/// `evaluations`. Any thread may call `stop`, if given, before a draw. Once `stop` returns true,
/// the ratios are invalid.
[[nodiscard]] std::vector<double> log_importance_ratios(const Problem& problem, int model,
                                                        const NormalMixture& proposal, int n,
                                                        std::uint64_t seed, int threads,
                                                        long& evaluations,
                                                        const std::function<bool()>& stop = {});

/// Shape k̂ of the generalised Pareto distribution fitted to the largest 3√n weights (Zhang &
/// Stephens 2009, Technometrics 51:316; Vehtari et al. 2024, JMLR 25(72):1): moments of the weights
/// up to the order 1/k̂ are finite. The result is -∞ if the fit has fewer than 5 weights.
[[nodiscard]] double pareto_shape(std::span<const double> log_weights);

/// Above this shape k̂, the sample variance of the weights does not give the error of their mean
/// (Vehtari et al. 2024).
inline constexpr double kHeavyTail = 0.7;

/// The fitted distribution of the largest weights.
struct ParetoTail {
  double shape = 0.0;  ///< shape k̂ (`pareto_shape`)
  /// Extrapolation of the tail: ln of the factor by which the mean weight would typically increase
  /// with 100 times as many draws; 0 without a fit.
  double log_excess = 0.0;
};
[[nodiscard]] ParetoTail pareto_tail(std::span<const double> log_weights);

}  // namespace wheeltap::inference
