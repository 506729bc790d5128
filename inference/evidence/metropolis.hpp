// Metropolis-Hastings within one model: a reference for reversible-jump results, and the draws for
// bridge sampling.
#pragma once

#include <cstdint>
#include <vector>

#include "base/eigen.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

struct MetropolisOptions {
  std::uint64_t seed = 1;
  int chains = 4;
  int warmup = 3000;  ///< warm-up iterations, in which the proposal adapts
  int draws = 5000;   ///< number of draws per chain, one per iteration
  int threads = 0;    ///< number of threads; 0: all threads of the machine. The results do not
                      ///< depend on this number.
};

/// Draws from the posterior of one model, separately for each chain.
struct ModelSamples {
  /// Draws in standard normal coordinates, one matrix (draws × dimension) per chain
  std::vector<Eigen::MatrixXd> z;
  std::vector<Eigen::MatrixXd> x;                  ///< draws in physical parameters
  std::vector<std::vector<double>> log_posterior;  ///< ln p₀ + ln prior factor + ln likelihood
  std::vector<std::vector<double>> log_likelihood;
  double acceptance = 0.0;  ///< acceptance rate after warm-up
  double rhat = 1.0;        ///< largest R-hat over the parameters and the log posterior
  long likelihood_evaluations = 0;
  std::vector<EvidenceWarning> warnings;
};

/// Random-walk Metropolis whose covariance adapts during warm-up (robust adaptive Metropolis,
/// Vihola 2012, Statistics and Computing 22:997). Each chain starts from the best of a few prior
/// draws. A chain stays in the posterior mode that it reaches first. A large R-hat shows that
/// chains are in different posterior modes.
///
/// Throws LikelihoodError if no prior draw has a positive likelihood, and std::invalid_argument for
/// options out of range.
[[nodiscard]] ModelSamples metropolis(const Problem& problem, int model,
                                      const MetropolisOptions& options);

/// Random-walk Metropolis in which half of the proposals are independent draws from `pilot`, so
/// that chains move between all posterior modes that the pilot covers. Each chain starts at a draw
/// from `pilot`.
[[nodiscard]] ModelSamples metropolis(const Problem& problem, int model, const NormalMixture& pilot,
                                      const MetropolisOptions& options);

}  // namespace wheeltap::inference
