// How each model stands: its probability by its draws or by its evidence, and the evidence itself.
//
//   P_m = (1 - Σ_evidence P_n) s_m / Σ_draws s_k   of a model that its draws speak for,
//   P_m = P(m) Z_m / Σ P(n) Z_n                    of one that they cannot.
#pragma once

#include <limits>
#include <vector>

#include "inference/diagnosis/mixing.hpp"
#include "inference/diagnosis/model_shares.hpp"
#include "inference/diagnosis/posterior.hpp"
#include "inference/evidence/comparison.hpp"

namespace wheeltap::inference {

/// Where a model's probability comes from: the share of its draws, or, where those cannot say
/// because no chain (or not every chain that should have) was there, its evidence.
enum class Basis { draws, evidence };

/// How one model stands.
struct ModelStanding {
  double probability = 0.0;  ///< 0 where nothing is known; `mcse` is then NaN
  /// Monte Carlo standard error of it. Of draws, never below 1 / (`ess_model` + 2), what one more
  /// or less effective visit would change, and with what annealing saw and the draws have not
  /// (annealed_excess); of the evidence, that of the evidences.
  double mcse = std::numeric_limits<double>::quiet_NaN();
  Basis basis = Basis::draws;
  int visited = 0;           ///< chains that drew it
  long proposed = 0;         ///< jumps into it that were proposed, after warm-up
  long entered = 0;          ///< and accepted
  long left = 0;             ///< accepted jumps out of it
  bool passed_over = false;  ///< never looked at nor drawn (ModelFindings::passed_over)
  /// ln Z and its standard error by the best method that could say (bridge sampling between its
  /// draws and its mixture; importance sampling from the mixture where it has no draws); NaN where
  /// none could.
  double log_evidence = std::numeric_limits<double>::quiet_NaN();
  double log_evidence_se = std::numeric_limits<double>::quiet_NaN();
};

/// How all of them stand, and what that was found from.
struct Standings {
  std::vector<ModelStanding> models;
  ImpliedProbabilities implied;  ///< by the evidences; of a model without one, by its draws
  std::vector<bool> missed;      ///< some chain lacks it that should have it
  std::vector<Evidence> evidence;
  /// Whether that is an average over the posterior's own draws or mixture.
  std::vector<bool> evidence_of_draws;
};

/// Bridge sampling knows the draws; importance sampling with a finite error has seen what it
/// weighs; annealing from the prior is the last resort. A model should be in every chain where its
/// probability by evidence times the effective draws of a chain exceeds 10.
[[nodiscard]] Standings standings(const Posterior& posterior, const ModelShares& shares,
                                  const Mixing& mixing);

/// ln B_ab, from the evidences where one of the two is known by its evidence alone, else from the
/// draws: the error is then the delta method's, of the mean of indicator_a / s_a - indicator_b /
/// s_b, and never below what one more or less effective visit to the rarer would change.
[[nodiscard]] Estimate log_bayes_factor(const Posterior& posterior, int a, int b);

}  // namespace wheeltap::inference
