// Transitional Markov chain Monte Carlo (TMCMC): evidence of one model by tempering from its prior.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/evidence/approximate_steps.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// How TMCMC adds the data of a record that can be shortened: all data at once, a growing part of
/// the record, or the better of these two ways.
enum class TmcmcPath { at_once, growing, better };

struct TmcmcOptions {
  std::uint64_t seed = 1;
  /// Number of independent replicates, at least 4. The scatter of the replicates gives the standard
  /// error.
  int replicates = 8;
  int samples = 500;        ///< number of samples per replicate
  double weight_cov = 0.5;  ///< coefficient of variation of the weights; sets the steps of β
  /// Required mean number of accepted moves per sample before the next stage. For
  /// the path of a growing record, which has many stages,
  /// half of this number is required.
  double acceptances = 6.0;
  TmcmcPath path = TmcmcPath::better;
  /// Optional, for an expensive likelihood or many dimensions: an approximation of ln prior factor
  /// + ln likelihood up to a constant. It must be finite at every finite z. Several threads may
  /// call this function at once. In stages in which the error of the approximation is small, the
  /// approximation screens moves (see `tmcmc`).
  LogApproximation approximation = nullptr;
  /// Number of likelihood evaluations after which the run ends early (`Tmcmc::cut`); 0: no limit.
  long most_evaluations = 0;
  int threads = 0;  ///< number of threads; 0: all threads of the machine. The results do not depend
                    ///< on this number.
  /// Callback, called from one thread at a time with the fraction of the work done since the last
  /// call. If the callback returns false, the run ends and ln Z is NaN.
  std::function<bool(double share)> progress = nullptr;
  /// Callback, called between two likelihood evaluations by any thread. If the callback returns
  /// true, the run ends.
  std::function<bool()> stop = nullptr;
};

struct Tmcmc {
  Evidence evidence;
  /// Posterior draws of all replicates, draws × dimension; empty if ln Z is NaN.
  Eigen::MatrixXd z;
  std::vector<double> log_posterior;  ///< ln π at each draw
  int stages = 0;                     ///< largest number of stages of any replicate
  /// Number of times that screened moves moved one half of the samples, over all replicates
  long screened = 0;
  /// True if the run reached most_evaluations. Then ln Z is NaN, z contains draws of the last
  /// tempered posteriors, and log_posterior is empty.
  bool cut = false;
};

/// TMCMC (Ching & Chen 2007, J. Engineering Mechanics 133:816) moves samples through the densities
///
///   π_j(z) ∝ p₀(z) [factor · likelihood]^{β_j},   0 = β_0 < … < β_m = 1,
///
/// where `factor` is the prior factor. Stage j weights the samples by [factor · likelihood]^(β_j -
/// β_{j-1}), resamples, and makes Metropolis moves. Z is the product of the mean weights.
///
/// If a problem can be shortened, the data may be added in parts (Chopin 2002, Biometrika
/// 89:539). With the first part, the densities π_j lead from the prior to the posterior given the
/// first 50 time samples of the record. Each further part at most doubles the number of time
/// samples. β is then the exponent of the likelihood of the new samples. The posterior of a long
/// record lies at the end of a ridge. The ridge narrows gradually as the number of time samples
/// increases, but suddenly as the exponent β increases. Small pilot runs with and without parts of
/// the data determine whether the data enter in parts.
///
/// Differences from the methods of Ching & Chen and of Chopin:
///
/// - Bisection finds the β for which the coefficient of variation of the weights is 0.5. With the
///   value 1 of Ching & Chen, ln Z was two nats too low for a chain of masses with a stop, whose
///   tempered posteriors change their orientation between stages.
/// - Resampling is systematic.
/// - The first stage removes prior draws with zero likelihood. The mean weight of this stage is the
///   fraction of prior draws with a positive likelihood. If draws with a positive likelihood are
///   rare, a replicate continues until 20 draws have a positive likelihood or 100 000 draws are
///   made. The estimate of this fraction remains unbiased.
/// - A third of the proposals are drawn from a normal mixture. The others are walks and
///   contractions (see SweepProposal), with scales adapted from sweep to sweep. Together, these
///   proposals keep the probabilities of separate posterior modes correct, and move far in many
///   dimensions.
/// - The mixture that proposes moves for one half of the samples is fitted to the other half.
/// - Sweeps continue until each sample has moved several times.
/// - All weights are computed in log space.
/// - With an approximation s(z) of ln (prior factor · likelihood), a move makes several Metropolis
///   steps that leave p₀ exp(β c s) invariant, 0 < c <= 1. The likelihood is then evaluated at the
///   last point y. With the error e = ln (prior factor · likelihood) - c s, the move from x to y is
///   accepted with probability min{1, exp(β [e(y) - e(x)])} (surrogate transition method: Liu 2001,
///   Monte Carlo Strategies in Scientific Computing, section 9.4.3; delayed acceptance: Christen &
///   Fox 2005). The moves therefore leave π_j invariant for every s. The factor c minimises the
///   standard deviation of β e over the other half of the samples. The moves use s only if this
///   standard deviation is below 1.5. If s lacks a posterior mode, samples at this mode have large
///   errors e, and all moves of this stage use only the likelihood.
///
/// ln Z is the log of the replicates' mean Z. The standard error of ln Z is the relative standard
/// error of this mean times √((R-1)/(R-3)). This factor is the standard deviation of Student's t
/// with R - 1 degrees of freedom; it is necessary because the standard error is estimated from only
/// R replicates.
///
/// If a replicate does not reach β = 1 within 1000 stages, ln Z and its standard error are NaN and
/// the result carries a warning.
///
/// Throws LikelihoodError if no prior draw has a positive likelihood, and std::invalid_argument for
/// options out of range.
[[nodiscard]] Tmcmc tmcmc(const Problem& problem, int model, const TmcmcOptions& options);

}  // namespace wheeltap::inference
