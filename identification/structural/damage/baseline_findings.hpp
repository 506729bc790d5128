// What the data say of the intact structure's parameters beside its damage.
#pragma once

#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

/// A parameter of the intact structure and a severity that cannot be told apart in a model: the
/// correlation of their standard normal coordinates, beyond `kEntangled`.
struct HiddenDamage {
  std::string model, parameter, severity;
  double correlation = 0.0;
};

struct BaselineFindings {
  std::vector<Contraction> contractions = {};  ///< of all models together
  std::vector<Marginal> marginals = {};        ///< one a contraction
  std::vector<std::string> priors = {};        ///< in words
  std::vector<Entangled> entangled = {};       ///< of the intact structure, all models together
  std::vector<HiddenDamage> hidden = {};       ///< in models of 5 % or more
  StatesLikelihood::Check check = {};          ///< of the modes, against full solutions
};

/// Of a problem with `states`, from draws of which every chain has as many, at least 4.
[[nodiscard]] BaselineFindings baseline_findings(const DamageProblem& problem,
                                                 const inference::Posterior& posterior);

/// 1 - variance and mean of z, and at which bound of the prior the draws x pile up.
[[nodiscard]] Contraction contraction_of(std::string name, const inference::Prior& prior,
                                         std::span<const double> x, std::span<const double> z,
                                         std::span<const double> weights);

}  // namespace wheeltap::identification
