// What a run may vouch for: of each model, whether it was visited and what its evidence says; and
// of the whole, whether it has converged and, where not, what is not established.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "inference/diagnostics.hpp"
#include "inference/reversible_jump.hpp"

namespace wheeltap::inference {

/// A quantity that means the same in every model, by which convergence is judged too.
struct Watched {
  std::string name;
  ChainsOf draws;
};

/// Where a model's probability comes from: the share of its draws, or, where those cannot say
/// because no chain (or not every chain that should have) was there, its evidence.
enum class Basis { draws, evidence };

/// How one model stands.
struct ModelStanding {
  double probability = 0.0;
  /// Monte Carlo standard error of it: of the draws, or, from the evidence, that of the evidences.
  double mcse = std::numeric_limits<double>::quiet_NaN();
  Basis basis = Basis::draws;
  int visited = 0;    ///< chains that drew it
  long proposed = 0;  ///< jumps into it that were proposed, after warm-up
  long entered = 0;   ///< and accepted
  long left = 0;      ///< accepted jumps out of it
  /// ln Z and its standard error by the best method that could say (bridge sampling between its
  /// draws and its mixture; importance sampling from the mixture where it has no draws); NaN where
  /// none could.
  double log_evidence = std::numeric_limits<double>::quiet_NaN();
  double log_evidence_se = std::numeric_limits<double>::quiet_NaN();
};

struct Verdict {
  std::vector<ModelStanding> models;  ///< one a model of the space
  bool converged = false;             ///< exactly where `not_established` is empty
  /// Sentences for people, the gravest first, each with what to do about it.
  std::vector<std::string> not_established;
  /// A mode that a climb from less than this share of the prior leads to would probably (1 in 100)
  /// not have been seen: 1 - 0.01^(1/n) for n climbs, the largest over the models that count; 1
  /// where nothing was searched.
  double resolution = 1.0;
  double rhat_max = std::numeric_limits<double>::quiet_NaN();
  std::string rhat_worst;          ///< the quantity that has it
  double ess_model = 0.0;          ///< smallest over the kinds' counts, or the models' indicators
  double ess_log_posterior = 0.0;  ///< the smaller of bulk and tail
};

/// Judges draws and what the searches found (Posterior::found) together. Converged needs all of:
///
/// - every model whose probability by evidence times the effective draws a chain exceeds 10 visited
///   at β = 1 by every chain;
/// - visits and evidence agreeing within their errors, and no evidence by annealing well above what
///   the draws have;
/// - every mode that the searches found and whose share of the draws should exceed 10 a chain
///   present in every chain, its share agreeing across chains (R-hat of its indicator);
/// - R-hat < 1.01 and effective sample sizes above 400 of the log posterior, the counts, `watched`,
///   and of the parameters within every model above 1 %;
/// - where draws were tempered, round trips of the ladder.
[[nodiscard]] Verdict judge(const Posterior& posterior, const std::vector<Watched>& watched = {});

}  // namespace wheeltap::inference
