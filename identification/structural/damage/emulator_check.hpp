// Whether an emulator moved the answer: a run's own draws, evaluated with the FE solution.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/structural/damage/damage_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// A quantity by the emulator's posterior and by the FE solution's.
struct Shift {
  double emulator = 0.0, fe = 0.0;
  double standard_error = 0.0;  ///< of their difference
};

struct EmulatorCheck {
  struct OfModel {
    Shift probability;
    bool compared = false;     ///< probable enough (5 %) for its parameters to be
    std::vector<Shift> means;  ///< one a parameter
  };
  /// What moved for certain: a model's probability, or the mean of one of its parameters.
  struct Moved {
    int model;
    int parameter;  ///< -1: the model's probability
    Shift shift;
  };
  struct Error {
    double rms = 0.0, largest = 0.0;  ///< in terms of the noise
  };

  int draws = 0;
  double mean_log_weight = 0.0, sd_log_weight = 0.0;
  double effective_share = 0.0;  ///< (Σw)² / (n Σw²)
  double pareto_shape = 0.0;     ///< beyond 0.7 the weights say only that the posteriors differ
  bool conclusive = false;
  std::vector<OfModel> models;
  std::vector<Moved> moved;
  std::vector<Error> error_to_noise;  ///< one a mode, over draws with damages
  int worst_mode = 1;                 ///< from 1

  [[nodiscard]] bool answer_moved() const { return !conclusive || !moved.empty(); }
};

/// Importance weights w = p(data | FE) / p(data | emulator) of up to `most` draws spread evenly
/// over the chains turn the sampled posterior into that of the FE solution:
///
///   P(m | FE) ≈ Σ_{draws in m} w / Σ w,
///
/// and so for means. None where no emulator takes part in the likelihood.
[[nodiscard]] std::optional<EmulatorCheck> check_emulator(const DamageProblem& problem,
                                                          const inference::Posterior& posterior,
                                                          int most = 2000);

}  // namespace wheeltap::identification
