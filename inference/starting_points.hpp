// Where chains start that tempering from the prior leaves in different places: for posteriors that
// are thousands of times narrower than their priors, as long records make them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "inference/evidence/laplace.hpp"
#include "inference/reporter.hpp"
#include "inference/reversible_jump.hpp"

namespace wheeltap::inference {

/// Samples of every model's posterior.
struct Populations {
  std::vector<Eigen::MatrixXd> z;  ///< of each model, draws × dimension; no rows: none found
  int best = -1;                   ///< the most probable model; -1: none has samples
  long likelihood_evaluations = 0;
};

/// By transitional MCMC on a growing record (tmcmc.hpp): a ridge of many narrow peaks is followed
/// as the data come in. Nothing where components are exchangeable (births find those), the prior
/// alone is wanted, or the caller stops.
[[nodiscard]] Populations growing_populations(const Problem& problem, const Options& options,
                                              Reporter& reporter);

/// Searchers × models, with the likelihoods that each took; the evidence is NaN where no mode was
/// found.
using Modes = std::vector<std::vector<Laplace>>;

/// Each searcher looks for the mode of each model by itself (laplace.hpp). Nothing as above.
[[nodiscard]] Modes search_modes(const Problem& problem, const Options& options, Reporter& reporter,
                                 int searchers);

/// For long records: samples of each model's posterior given the first few thousand samples, and
/// Newton steps from the best of them as the record grows to its whole length. One searcher.
/// `problem` must have `shortened`.
[[nodiscard]] Modes climb_with_record(const Problem& problem, const Options& options,
                                      Reporter& reporter);

}  // namespace wheeltap::inference
