// From evidences to model probabilities, and whether a jump sampler agrees with them.
#pragma once

#include <string>
#include <vector>

#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// P(m | data) = P(m) Z_m / Σ P(n) Z_n, and the standard errors of P and of ln P that those of the
/// evidences bring about (delta method: ∂P_m/∂ln Z_n = P_m (δ_mn - P_n)). NaN where one is not
/// known.
struct ImpliedProbabilities {
  std::vector<double> mean;
  std::vector<double> standard_error;
};

/// One evidence a model of the space. Throws std::invalid_argument for another number of them.
[[nodiscard]] ImpliedProbabilities implied_probabilities(const ModelSpace& space,
                                                         const std::vector<Evidence>& evidences);

/// A model whose sampled probability and the implied one are too far apart.
struct Disagreement {
  int model;
  double sampled, sampled_error, implied, implied_error;
};

/// The models for which they differ by more than `sigmas` of their combined standard error (and by
/// more than `least`, below which nobody cares). None where an error is not known (Laplace's):
/// there is nothing to judge by.
[[nodiscard]] std::vector<Disagreement> disagreements(const std::vector<double>& sampled,
                                                      const std::vector<double>& sampled_error,
                                                      const ImpliedProbabilities& implied,
                                                      double sigmas = 3.0, double least = 1e-3);

}  // namespace wheeltap::inference
