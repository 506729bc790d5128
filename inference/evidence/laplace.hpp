// The mode of one model, and Laplace's evidence.
#pragma once

#include <cstdint>

#include "base/eigen.hpp"
#include "inference/evidence/metropolis.hpp"
#include "inference/search/optimum.hpp"

namespace wheeltap::inference {

struct ModeOptions {
  std::uint64_t seed = 1;
  int restarts = 3;  ///< of differential evolution; the best is polished
  int generations = 300;
  double tolerance = 1e-3;      ///< in ln π, of differential evolution; the polish goes further
  std::vector<double> start{};  ///< z to climb from by Newton steps alone; empty: search
  bool check = true;            ///< Laplace only: warn of a posterior that does not look normal
};

/// Mode of ln π(z), by self-adaptive differential evolution and Newton steps on finite differences;
/// where the problem can be shortened, on its first 50 samples, then on twice as many about the
/// mode of those, and so on to the whole record. Throws LikelihoodError where no point of the
/// search has a finite likelihood.
[[nodiscard]] Optimum maximum_a_posteriori(const Problem& problem, int model,
                                           const ModeOptions& options);

struct Laplace {
  Evidence evidence;  ///< standard error NaN
  std::vector<double> z;
  std::vector<double> x;       ///< the mode in physical parameters
  Eigen::MatrixXd covariance;  ///< inverse of minus the Hessian, of z
};

/// ln Z ≈ ln π(z*) + (d/2) ln 2π - ½ ln|H|, H = -∇² ln π at the mode z*, in standard normal
/// coordinates, so that the prior's bounds are no edges. H is by central differences over steps
/// that lower ln π by about 0.05. It knows one mode only. It warns where H is not positive
/// definite, and where importance sampling about the mode (1000 draws) finds something else than a
/// normal: a likelihood that is constant within an element, for one, has the curvature of its
/// prior.
[[nodiscard]] Laplace laplace(const Problem& problem, int model, const ModeOptions& options);

}  // namespace wheeltap::inference
