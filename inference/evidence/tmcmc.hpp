// Transitional Markov chain Monte Carlo: the evidence of one model by tempering from its prior.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/mixtures/normal_mixture.hpp"
#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// How the data come in, where the problem can be shortened.
enum class TmcmcPath { at_once, growing, better };

struct TmcmcOptions {
  std::uint64_t seed = 1;
  int replicates = 8;        ///< independent runs, whose scatter is the standard error; >= 4
  int samples = 500;         ///< a replicate
  double weight_cov = 0.5;   ///< coefficient of variation of the weights that sets each step of β
  double acceptances = 6.0;  ///< moves accepted a sample and stage, on average, before going on
                             ///< (half of that as a record grows: there are many stages)
  TmcmcPath path = TmcmcPath::better;
  /// Likelihood calls after which a run ends where it is (`Tmcmc::cut`); 0: as many as it takes.
  long most_evaluations = 0;
  int threads = 0;  ///< 0: as many as the machine has. Never changes a result.
  /// Called, from one thread at a time, with the share of the whole that was done since the call
  /// before. Returning false ends the run: ln Z is then NaN.
  std::function<bool(double share)> progress = nullptr;
  /// Asked between two likelihoods, by any thread; true ends the run likewise.
  std::function<bool()> stop = nullptr;
};

struct Tmcmc {
  Evidence evidence;
  /// Posterior draws of all replicates together, draws × dimension; no draws where ln Z is NaN.
  Eigen::MatrixXd z;
  std::vector<double> log_posterior;  ///< ln π at each of these
  int stages = 0;                     ///< the most of any replicate
  /// The calls were spent on the way: ln Z is NaN, z are draws of the tempered posteriors that were
  /// reached, log_posterior is empty.
  bool cut = false;
};

/// Ching & Chen (2007, J. Engineering Mechanics 133:816): samples pass through
///
///   π_j(z) ∝ p₀(z) [factor · likelihood]^{β_j},   0 = β_0 < … < β_m = 1,
///
/// by weighting with the power of the step, resampling, and Metropolis moves, and
/// Z = ∏_j mean of the weights of step j.
///
/// Where the problem can be shortened, the data may come in parts (Chopin 2002, Biometrika 89:539):
/// from the prior to the posterior of the first 50 samples, from there to that of up to twice as
/// many, and so on; β is then the exponent of what the new samples say. A long record's posterior
/// lies at the end of a ridge that narrows by and by with the record, but all at once with the
/// exponent. A few small runs of either kind decide, and are not used otherwise.
///
/// Beyond the papers: β by bisection on the weights' coefficient of variation, half of which is
/// enough where a posterior bends from step to step (1, as in the paper, lost two nats on a chain
/// with a stop); systematic resampling; prior draws of likelihood zero are a step of their own,
/// whose weight is the share of possible draws (where those are rare, draws go on until 20 are
/// possible, or 100 000 were drawn a replicate, and the share's estimate stays unbiased);
/// half of the moves are drawn from a normal mixture and half are steps with the covariance of one
/// of its components, at a scale adapted from sweep to sweep, so that separate modes stay balanced;
/// the mixture that moves one half of the samples is fitted to the other half; sweeps until each
/// sample has moved several times; everything in log space.
///
/// ln Z is the log of the replicates' mean Z. Its standard error is from their scatter, times
/// √((R-1)/(R-3)) for knowing the scatter from R replicates only (the sd of Student's t).
///
/// Where a replicate does not reach β = 1 within 1000 stages, ln Z and its standard error are NaN
/// and a warning says so.
///
/// Throws LikelihoodError where no prior draw has a finite likelihood; std::invalid_argument for
/// options out of range.
[[nodiscard]] Tmcmc tmcmc(const Problem& problem, int model, const TmcmcOptions& options);

}  // namespace wheeltap::inference
