// The mode of one model, and Laplace's evidence.
#pragma once

#include <cstdint>

#include "base/eigen.hpp"
#include "inference/evidence/metropolis.hpp"
#include "inference/search/optimum.hpp"

namespace wheeltap::inference {

struct ModeOptions {
  std::uint64_t seed = 1;
  int restarts = 3;  ///< of differential evolution; Newton steps refine the best
  int generations = 300;
  double tolerance = 1e-3;  ///< in ln π, of differential evolution; the Newton steps go further
  std::vector<double> start{};  ///< z where Newton steps start, without a search; empty: search
  bool check = true;            ///< Laplace only: warn if the posterior is not normal
};

/// Mode of ln π(z), by self-adaptive differential evolution and Newton steps with finite
/// differences. If the problem can be shortened, the search begins with the first 50 samples. It
/// then doubles the number of samples, starting each time from the previous mode, until the record
/// is complete. Throws LikelihoodError if no point of the search has a finite likelihood.
[[nodiscard]] Optimum maximum_a_posteriori(const Problem& problem, int model,
                                           const ModeOptions& options);

struct Laplace {
  Evidence evidence;  ///< standard error NaN
  std::vector<double> z;
  std::vector<double> x;       ///< the mode in physical parameters
  Eigen::MatrixXd covariance;  ///< inverse of minus the Hessian, in z
};

/// ln Z ≈ ln π(z*) + (d/2) ln 2π - ½ ln|H|, H = -∇² ln π at the mode z*, in standard normal
/// coordinates, in which the prior has no bounds. H comes from central differences with steps that
/// lower ln π by about 0.05. The method covers one mode only. The result has a warning if H is not
/// positive definite, or if importance sampling at the mode (1000 draws) shows that the posterior
/// is not normal. For example, if the likelihood is constant within an element, the curvature at
/// the mode is that of the prior.
[[nodiscard]] Laplace laplace(const Problem& problem, int model, const ModeOptions& options);

}  // namespace wheeltap::inference
