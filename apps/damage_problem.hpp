// From a damage case to a problem for the engine: model space, likelihood and symmetries.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "apps/damage_case.hpp"
#include "apps/frequency_emulator.hpp"
#include "inference/target.hpp"

namespace wheeltap::apps {

/// All that a run needs, kept together because the problem's likelihood refers to it.
struct DamageProblem {
  DamageCase damage_case;
  std::shared_ptr<const fem::Reanalysis> reanalysis;
  std::shared_ptr<const FrequencyEmulator>
      emulator;  ///< null where the FE solution itself predicts
  inference::Problem problem;
  bool symmetric = false;  ///< the intact beam and the location priors equal their mirror images
  int common = 0;          ///< parameters that all models have: 1 where cov is inferred

  /// The components of a parameter vector of `model`, in the order of kinds.
  struct Component {
    int kind;
    double location;
    double severity;  ///< reduction, or stiffness (∞: rigid)
  };
  [[nodiscard]] std::vector<Component> components(int model, std::span<const double> x) const;
};

struct DamageProblemOptions {
  int threads = 1;
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> table_progress = {};
};

/// Trains or reads the emulator where the case asks for one. The log likelihood is
///
///   Σ over measured modes of  -½ ((f_obs - f) / sd)² - ln(sd √2π),
///   sd² = (cov f_obs)² + (emulator's RMSE on held-out runs)²,
///
/// the second term where an emulator predicts and its error is not switched off. Throws Failure.
[[nodiscard]] std::unique_ptr<const DamageProblem> make_damage_problem(
    DamageCase damage_case, const DamageProblemOptions& options);

}  // namespace wheeltap::apps
