// Probability of each model, from its draws or its evidence, and evidence of each model.
//
//   P_m = (1 - Σ_evidence P_n) s_m / Σ_draws s_k   if P_m comes from the draws of model m,
//   P_m = P(m) Z_m / Σ P(n) Z_n                    if P_m comes from the evidence of model m.
#pragma once

#include <limits>
#include <vector>

#include "inference/diagnosis/mixing.hpp"
#include "inference/diagnosis/model_shares.hpp"
#include "inference/diagnosis/posterior.hpp"
#include "inference/evidence/comparison.hpp"

namespace wheeltap::inference {

/// Source of a model probability: the fraction of draws in the model, or the evidence if a chain
/// should have visited the model but did not.
enum class Basis { draws, evidence };

/// Probability and evidence of one model.
struct ModelStanding {
  double probability = 0.0;  ///< model probability; if unknown: 0, and `mcse` is NaN
  /// Monte Carlo standard error of `probability`. For a probability from draws, the error is at
  /// least 1 / (`ess_model` + 2), the effect of one additional or missing effective draw; the error
  /// includes the excess of SMC draws (annealed_excess). For a probability from evidence, the error
  /// follows from the errors of all evidences.
  double mcse = std::numeric_limits<double>::quiet_NaN();
  Basis basis = Basis::draws;
  int visited = 0;    ///< number of chains with draws of the model
  long proposed = 0;  ///< proposed jumps into the model after warm-up
  long entered = 0;   ///< accepted jumps into the model
  long left = 0;      ///< accepted jumps out of the model
  /// True if the model was neither evaluated nor drawn (ModelFindings::passed_over)
  bool passed_over = false;
  /// ln Z of the model and its standard error by the best available method: bridge sampling between
  /// the model's draws and its mixture, or importance sampling from the mixture for a model without
  /// draws. NaN if no method succeeded.
  double log_evidence = std::numeric_limits<double>::quiet_NaN();
  double log_evidence_se = std::numeric_limits<double>::quiet_NaN();
};

/// Probabilities of all models, and the quantities from which the probabilities were computed.
struct Standings {
  std::vector<ModelStanding> models;
  /// Model probabilities from the evidences; from the draws for models without evidence
  ImpliedProbabilities implied;
  /// Per model: true if some chain should have visited the model, but has no draws of it
  std::vector<bool> missed;
  std::vector<Evidence> evidence;
  /// Per model: true if its evidence comes from its posterior draws or from draws of its mixture.
  std::vector<bool> evidence_of_draws;
};

/// Computes the probabilities. The evidence of a model comes from bridge sampling, which uses the
/// draws. If bridge sampling has no result, the evidence comes from importance sampling or, if its
/// error exceeds 1, from SMC. Every chain should visit a model if the model probability from
/// the evidence, times the effective draws per chain, exceeds 10.
[[nodiscard]] Standings standings(const Posterior& posterior, const ModelShares& shares,
                                  const Mixing& mixing);

/// ln of the Bayes factor B_ab of models a and b. If the probability of a or b comes from its
/// evidence, B_ab follows from the evidences, otherwise from the draws. For draws, the error is the
/// standard error of the mean of indicator_a / s_a - indicator_b / s_b (delta method). The error is
/// at least the effect of one additional effective draw of the less probable model.
[[nodiscard]] Estimate log_bayes_factor(const Posterior& posterior, int a, int b);

}  // namespace wheeltap::inference
