// Posterior of the intact structure's parameters, and their correlation with damage.
#pragma once

#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

/// A parameter of the intact structure and a severity whose effects the data cannot distinguish in
/// a model: the correlation of their standard normal coordinates exceeds `kEntangled`.
struct HiddenDamage {
  std::string model, parameter, severity;
  double correlation = 0.0;
};

struct BaselineFindings {
  std::vector<Contraction> contractions = {};  ///< over all models
  std::vector<Marginal> marginals = {};        ///< posterior of each parameter
  std::vector<std::string> priors = {};        ///< description of each prior
  std::vector<Entangled> entangled = {};  ///< parameters of the intact structure, over all models
  std::vector<HiddenDamage> hidden = {};  ///< hidden damages in models with a probability of 5 % or
                                          ///< more
  StatesLikelihood::Check check = {};     ///< comparison of computed modes with full solutions
};

/// Computes the findings of a problem with `states`. All chains must have the same number of draws,
/// at least 4.
[[nodiscard]] BaselineFindings baseline_findings(const DamageProblem& problem,
                                                 const inference::Posterior& posterior);

/// Computes the contraction (1 - variance of z), the mean of z, and the bound of the prior at which
/// the draws x pile up. z are the standard normal coordinates of x.
[[nodiscard]] Contraction contraction_of(std::string name, const inference::Prior& prior,
                                         std::span<const double> x, std::span<const double> z,
                                         std::span<const double> weights);

}  // namespace wheeltap::identification
