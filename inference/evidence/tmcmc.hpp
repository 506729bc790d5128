// Transitional Markov chain Monte Carlo (TMCMC): evidence of one model by tempering from its prior.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// Order in which data enter, for problems that can be shortened.
enum class TmcmcPath { at_once, growing, better };

struct TmcmcOptions {
  std::uint64_t seed = 1;
  int replicates = 8;       ///< independent runs; their scatter gives the standard error; >= 4
  int samples = 500;        ///< per replicate
  double weight_cov = 0.5;  ///< coefficient of variation of the weights, which sets each step of β
  /// Accepted moves per sample and stage, on average, before the next stage. For a growing record,
  /// which has many stages, this number is halved.
  double acceptances = 6.0;
  TmcmcPath path = TmcmcPath::better;
  /// Likelihood calls after which a run ends early (`Tmcmc::cut`); 0: no limit.
  long most_evaluations = 0;
  int threads = 0;  ///< 0: as many as the machine has. Never changes a result.
  /// Called from one thread at a time with the share of the work done since the last call.
  /// Returning false ends the run; ln Z is then NaN.
  std::function<bool(double share)> progress = nullptr;
  /// Called between two likelihoods by any thread; returning true also ends the run.
  std::function<bool()> stop = nullptr;
};

struct Tmcmc {
  Evidence evidence;
  /// Posterior draws of all replicates, draws × dimension; empty if ln Z is NaN.
  Eigen::MatrixXd z;
  std::vector<double> log_posterior;  ///< ln π at each draw
  int stages = 0;                     ///< the largest number of any replicate
  /// The run reached most_evaluations: ln Z is NaN, z are draws of the tempered posteriors reached,
  /// and log_posterior is empty.
  bool cut = false;
};

/// Ching & Chen (2007, J. Engineering Mechanics 133:816): samples pass through
///
///   π_j(z) ∝ p₀(z) [factor · likelihood]^{β_j},   0 = β_0 < … < β_m = 1,
///
/// by weighting with the power of the step, resampling, and Metropolis moves. Z = ∏_j mean of the
/// weights of step j.
///
/// For problems that can be shortened, the data may enter in parts (Chopin 2002, Biometrika
/// 89:539). The first part leads from the prior to the posterior of the first 50 samples; each
/// further part leads to the posterior of up to twice as many. β is then the exponent of the
/// likelihood of the new samples. The posterior of a long record lies at the end of a ridge. The
/// ridge narrows gradually with the number of samples, but suddenly with the exponent. Small pilot
/// runs of both kinds decide which one to use.
///
/// Differences from these papers:
///
/// - Bisection on the coefficient of variation of the weights sets β. The target is 0.5. With the
///   value 1 of the paper, ln Z was two nats too low for a chain with a stop, whose tempered
///   posteriors change direction from step to step.
/// - Resampling is systematic.
/// - The first step removes prior draws of likelihood zero; its weight is the share of possible
///   draws. If possible draws are rare, more draws are made until 20 are possible or a replicate
///   has 100 000 draws; the estimate of the share remains unbiased.
/// - Half of the moves are drawn from a normal mixture. The other half are steps with the
///   covariance of one of its components, with a scale adapted from sweep to sweep. This keeps
///   separate modes balanced.
/// - The mixture that moves one half of the samples is fitted to the other half.
/// - Sweeps continue until each sample has moved several times.
/// - All weights are computed in log space.
///
/// ln Z is the log of the replicates' mean Z. Its standard error is their scatter times
/// √((R-1)/(R-3)), the sd of Student's t, since the scatter is known from R replicates only.
///
/// If a replicate does not reach β = 1 within 1000 stages, ln Z and its standard error are NaN and
/// the result carries a warning.
///
/// Throws LikelihoodError if no prior draw has a finite likelihood; std::invalid_argument for
/// options out of range.
[[nodiscard]] Tmcmc tmcmc(const Problem& problem, int model, const TmcmcOptions& options);

}  // namespace wheeltap::inference
