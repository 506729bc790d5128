// The posterior mode of one model, and the evidence by Laplace's method.
#pragma once

#include <cstdint>

#include "base/eigen.hpp"
#include "inference/evidence/metropolis.hpp"
#include "inference/search/optimum.hpp"

namespace wheeltap::inference {

struct ModeOptions {
  std::uint64_t seed = 1;
  int restarts = 3;  ///< runs of differential evolution; Newton steps refine the best result
  int generations = 300;
  /// Tolerance of differential evolution in ln π; Newton steps refine the result
  double tolerance = 1e-3;
  /// Starting point z of the Newton steps, which then replace the search; empty: search first
  std::vector<double> start{};
  bool check = true;  ///< true: Laplace's method warns if the posterior is not normal
};

/// Finds the maximum of ln π(z) by self-adaptive differential evolution and Newton steps with
/// finite differences. If the problem can be shortened, the search begins with the first 50
/// samples. The search then doubles the number of samples until the record is complete. Each search
/// starts from the posterior mode for the shorter record. Throws LikelihoodError if no point of the
/// search has a positive likelihood.
[[nodiscard]] Optimum maximum_a_posteriori(const Problem& problem, int model,
                                           const ModeOptions& options);

struct Laplace {
  Evidence evidence;  ///< evidence; its standard error is NaN
  std::vector<double> z;
  std::vector<double> x;       ///< the posterior mode in physical parameters
  Eigen::MatrixXd covariance;  ///< inverse of minus the Hessian, in z
};

/// ln Z ≈ ln π(z*) + (d/2) ln 2π - ½ ln|H|, H = -∇² ln π at the posterior mode z*, in standard
/// normal coordinates, in which the prior has no bounds. H is computed by central differences with
/// steps that lower ln π by about 0.05. The method covers one posterior mode only. The result has a
/// warning if H is not positive definite, or if importance sampling at the posterior mode (1000
/// draws) shows that the posterior is not normal. An example is a likelihood that is constant for
/// locations within a finite element: the curvature of ln π along the location is that of the
/// prior.
[[nodiscard]] Laplace laplace(const Problem& problem, int model, const ModeOptions& options);

}  // namespace wheeltap::inference
