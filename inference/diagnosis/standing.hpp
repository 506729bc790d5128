// Probability of each model, from its draws or its evidence, and evidence of each model.
//
//   P_m = (1 - Σ_evidence P_n) s_m / Σ_draws s_k   for a model judged by its draws,
//   P_m = P(m) Z_m / Σ P(n) Z_n                    for a model judged by its evidence.
#pragma once

#include <limits>
#include <vector>

#include "inference/diagnosis/mixing.hpp"
#include "inference/diagnosis/model_shares.hpp"
#include "inference/diagnosis/posterior.hpp"
#include "inference/evidence/comparison.hpp"

namespace wheeltap::inference {

/// Source of a model's probability: the share of its draws, or its evidence if a chain that should
/// have visited the model did not.
enum class Basis { draws, evidence };

/// Probability and evidence of one model.
struct ModelStanding {
  double probability = 0.0;  ///< 0 if nothing is known; `mcse` is then NaN
  /// Monte Carlo standard error of `probability`. For a probability from draws it is at least 1 /
  /// (`ess_model` + 2), the effect of one effective visit more or less, and it includes the excess
  /// of the SMC draws (annealed_excess). For a probability from evidence it follows from the errors
  /// of all evidences.
  double mcse = std::numeric_limits<double>::quiet_NaN();
  Basis basis = Basis::draws;
  int visited = 0;           ///< number of chains that drew it
  long proposed = 0;         ///< proposed jumps into it after warm-up
  long entered = 0;          ///< accepted jumps into it
  long left = 0;             ///< accepted jumps out of it
  bool passed_over = false;  ///< neither evaluated nor drawn (ModelFindings::passed_over)
  /// ln Z and its standard error by the best method available: bridge sampling between its draws
  /// and its mixture, or importance sampling from the mixture if it has no draws. NaN if no method
  /// succeeded.
  double log_evidence = std::numeric_limits<double>::quiet_NaN();
  double log_evidence_se = std::numeric_limits<double>::quiet_NaN();
};

/// Probabilities of all models and the quantities that they follow from.
struct Standings {
  std::vector<ModelStanding> models;
  ImpliedProbabilities implied;  ///< by the evidences; for a model without evidence, by its draws
  std::vector<bool> missed;      ///< some chain should have visited it and did not
  std::vector<Evidence> evidence;
  /// True if the evidence of a model is an average over the posterior's own draws or mixture.
  std::vector<bool> evidence_of_draws;
};

/// Computes the probabilities. The evidence of a model is taken from bridge sampling, which uses
/// the draws; otherwise from importance sampling with a finite error; otherwise from SMC. Every
/// chain should visit a model if its probability by evidence times the number of effective draws
/// per chain exceeds 10.
[[nodiscard]] Standings standings(const Posterior& posterior, const ModelShares& shares,
                                  const Mixing& mixing);

/// ln B_ab, from the evidences if one of the two models is judged by its evidence, else from the
/// draws. For draws, the error is that of the mean of indicator_a / s_a - indicator_b / s_b (delta
/// method), and at least the effect of one effective visit more or less to the less probable model.
[[nodiscard]] Estimate log_bayes_factor(const Posterior& posterior, int a, int b);

}  // namespace wheeltap::inference
