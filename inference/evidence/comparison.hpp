// Model probabilities from evidences, and their comparison with sampled probabilities.
#pragma once

#include <string>
#include <vector>

#include "inference/model/model_posterior.hpp"

namespace wheeltap::inference {

/// P(m | data) = P(m) Z_m / Σ P(n) Z_n, and the standard errors of P and of ln P. The errors follow
/// from the errors of the evidences (delta method: ∂P_m/∂ln Z_n = P_m (δ_mn - P_n)). The errors are
/// NaN if the error of an evidence is unknown.
struct ImpliedProbabilities {
  std::vector<double> mean;
  std::vector<double> standard_error;
};

/// Computes the model probabilities that the evidences imply. `evidences` has one entry per model
/// of the space. Throws std::invalid_argument if the number of evidences differs from the number of
/// models.
[[nodiscard]] ImpliedProbabilities implied_probabilities(const ModelSpace& space,
                                                         const std::vector<Evidence>& evidences);

/// A model with a significant difference between its sampled and its implied probability.
struct Disagreement {
  int model;
  double sampled, sampled_error, implied, implied_error;
};

/// Returns the models whose sampled probabilities differ from the probabilities implied by the
/// evidences. A difference must exceed both `sigmas` combined standard errors and `least`. The list
/// is empty if the standard error of an evidence is unknown (as for Laplace's method).
[[nodiscard]] std::vector<Disagreement> disagreements(const std::vector<double>& sampled,
                                                      const std::vector<double>& sampled_error,
                                                      const ImpliedProbabilities& implied,
                                                      double sigmas = 3.0, double least = 1e-3);

}  // namespace wheeltap::inference
