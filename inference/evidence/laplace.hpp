// The mode of one model, Laplace's evidence, and the information criteria.
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
/// The same for the likelihood alone, within |z| <= 8: the prior's support but for a share of
/// 1e-15.
[[nodiscard]] Optimum maximum_likelihood(const Problem& problem, int model,
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

struct InformationCriteria {
  double bic = 0.0;  ///< k ln n - 2 ln L_max
  double aic = 0.0;  ///< 2k - 2 ln L_max
  double max_log_likelihood = 0.0;
  long likelihood_evaluations = 0;
};

/// `observations` is the n of BIC. Throws std::invalid_argument for observations < 1.
[[nodiscard]] InformationCriteria information_criteria(const Problem& problem, int model,
                                                       long observations,
                                                       const ModeOptions& options);

struct Dic {
  double dic = 0.0;  ///< mean deviance + effective_parameters, deviance = -2 ln L
  double effective_parameters = 0.0;
};

/// Deviance information criterion from posterior draws, its effective number of parameters half the
/// variance of the deviance (Gelman et al. 2014, Bayesian Data Analysis, eq. 7.10): unlike the
/// deviance at the posterior mean (Spiegelhalter et al. 2002) it does not depend on the
/// parameterisation and is not misled by several modes.
[[nodiscard]] Dic deviance_information_criterion(const ModelSamples& samples);

}  // namespace wheeltap::inference
