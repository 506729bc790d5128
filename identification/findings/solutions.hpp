// Separate solutions: regions of one model's posterior with different parameter values and little
// probability between the regions.
//
// Distances are computed in the coordinates in which the prior is standard normal, scaled by the
// covariance of the draws about their nearest posterior mode. A search finds the posterior modes;
// each draw belongs to the mode nearest to it. Two posterior modes are one solution if the smallest
// distance between their draws is at most 3 q. Here,
//
//   q = the 95 % quantile of the distance from a draw to the nearest other draw of its mode.
//
// If q differs between the two posterior modes, the larger q is used. In one dimension, the
// density between separate solutions is then below about a thirtieth of its peak value. A ridge of
// the density is one solution, even if the ridge is curved or rough.
#pragma once

#include <vector>

#include "identification/findings/marginal.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

struct Solution {
  double probability = 0.0, mcse = 0.0;  ///< fraction of the model's draws, with its error
  std::vector<double> best = {};         ///< parameters of the most probable draw of the solution
  /// Marginals of the draws of the solution, one per parameter
  std::vector<Marginal> parameters = {};
  double chi_square = 0.0;  ///< χ² of the residuals at `best`; NaN if not computed
};

/// Solutions with a probability below this value are omitted.
inline constexpr double kWorthListing = 0.01;

struct SeparateSolutions {
  /// Solutions, the most probable first; empty if there is only one solution.
  std::vector<Solution> list = {};
  /// Covariance of draws about the mean of their solution, in standard normal coordinates: the
  /// uncertainty within a solution. Empty if `list` is empty.
  Eigen::MatrixXd covariance_within = {};
};

/// Finds the solutions of a model that has only parameters and no components.
[[nodiscard]] SeparateSolutions separate_solutions(const inference::Posterior& posterior,
                                                   int model);

}  // namespace wheeltap::identification
