// Separate solutions: regions of one model's posterior that explain the data by other parameter
// values, with little probability between them.
//
// Each draw belongs to the nearest mode of the search, in the covariance of draws about their own
// mode; distances are in that, and coordinates are those in which the prior is standard normal. Two
// modes are one solution where some of their draws are no further apart than
//
//   3 × the 95 % quantile of the distance of a draw to the nearest other one of its mode,
//
// the larger of the two: where the density between them falls to about a thirtieth of its height in
// one dimension. So a curved or a rough ridge is one solution.
#pragma once

#include <vector>

#include "identification/findings/marginal.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

struct Solution {
  double probability = 0.0, mcse = 0.0;   ///< share of the model's draws
  std::vector<double> best = {};          ///< its most probable draw: parameters
  std::vector<Marginal> parameters = {};  ///< of its draws, one a parameter
  double chi_square = 0.0;                ///< of the data at `best`; NaN where it is not computed
};

/// Of less probability than this a solution is left out.
inline constexpr double kWorthListing = 0.01;

struct SeparateSolutions {
  /// The most probable first; empty where there is one solution only.
  std::vector<Solution> list = {};
  /// Of all draws about the mean of their own solution, in standard normal coordinates: what is
  /// uncertain within a solution. Empty where `list` is.
  Eigen::MatrixXd covariance_within = {};
};

/// Of a model with parameters only, no components.
[[nodiscard]] SeparateSolutions separate_solutions(const inference::Posterior& posterior,
                                                   int model);

}  // namespace wheeltap::identification
