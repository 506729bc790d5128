// Effect of an emulator on the posterior, estimated from FE solutions at posterior draws.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/structural/damage/damage_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// The posterior mean of a quantity with the emulator and with the FE solution.
struct Shift {
  double emulator = 0.0, fe = 0.0;
  double standard_error = 0.0;  ///< standard error of the difference of both means
};

struct EmulatorCheck {
  struct OfModel {
    Shift probability;
    /// True if the parameters of the model are compared, because its probability is at least 5 %
    bool compared = false;
    std::vector<Shift> means;  ///< one per parameter
  };
  /// A significant change of a model's probability, or of the mean of one of its parameters.
  struct Moved {
    int model;
    int parameter;  ///< parameter index; -1: the model's probability
    Shift shift;
  };
  struct Error {
    double rms = 0.0, largest = 0.0;  ///< emulator error divided by the noise sd
  };

  int draws = 0;
  double mean_log_weight = 0.0, sd_log_weight = 0.0;
  double effective_share = 0.0;  ///< effective sample size divided by n: (Σw)² / (n Σw²)
  double pareto_shape = 0.0;     ///< above 0.7, reweighting is unreliable: posteriors differ
  bool conclusive = false;
  std::vector<OfModel> models;
  std::vector<Moved> moved;
  std::vector<Error> error_to_noise;  ///< one per mode, over draws with damages
  int worst_mode = 1;                 ///< number of the mode, from 1

  [[nodiscard]] bool answer_moved() const { return !conclusive || !moved.empty(); }
};

/// Reweights up to `most` draws, spread evenly over the chains, to the posterior of the FE
/// solution. With importance weights w = p(data | FE) / p(data | emulator),
///
///   P(m | FE) ≈ Σ_{draws in m} w / Σ w,
///
/// and correspondingly for means. The result is empty if the likelihood does not use an emulator.
[[nodiscard]] std::optional<EmulatorCheck> check_emulator(const DamageProblem& problem,
                                                          const inference::Posterior& posterior,
                                                          int most = 2000);

}  // namespace wheeltap::identification
