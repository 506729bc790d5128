// Conversion of a damage case to an inference problem: model space, likelihood and symmetries.
#pragma once

#include <functional>
#include <memory>

#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/damage/frequency_emulator.hpp"
#include "identification/structural/defects/site_symmetries.hpp"
#include "identification/structural/forward/program_model.hpp"
#include "identification/structural/problem/structural_problem.hpp"

namespace wheeltap::identification {

/// The inference problem of a damage case. All models share these parameters, in this order: noise
/// parameters, parameters of the intact structure, noise parameters of added observations.
struct DamageProblem : StructuralProblem {
  DamageCase damage_case = {};
  std::shared_ptr<const FrequencyEmulator> emulator = {};  ///< emulator of a forward model; or null
  std::shared_ptr<const ForwardModel> emulated = {};       ///< the model that is emulated; or null
  /// Likelihood that always uses the FE solution
  inference::LikelihoodFactory fe_likelihood = {};
  /// True if the intact beam and the location priors are mirror-symmetric, and no data (such as
  /// shapes) distinguish the two sides.
  bool symmetric = false;
  SiteSymmetries symmetries = {};  ///< symmetries of structure and data
  int common = 0;                  ///< number of parameters that all models share
  /// True if Wheeltap's FE model predicts (no external model and no user's model), and the only
  /// observations are the data of the case.
  bool as_case = true;

  /// The external program or server that replaces the FE solution; or null.
  [[nodiscard]] const ProgramModel* program() const {
    return dynamic_cast<const ProgramModel*>(model.get());
  }

  using Component = PlacedDefect;
  /// True if the emulator only screens proposals, so that the posterior uses the FE solution.
  [[nodiscard]] bool exact() const { return emulator && damage_case.emulator->exact; }
  /// The forward model whose predictions the likelihood uses.
  [[nodiscard]] const ForwardModel& predicting() const {
    return emulated && !exact() ? *emulated : *model;
  }
  [[nodiscard]] NoiseModel noise() const { return NoiseModel(damage_case.data); }
};

struct DamageProblemOptions {
  int threads = 1;
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> table_progress = {};
  /// Replaces the FE solution: predicts the elastic frequencies [Hz] of a beam. The inputs are
  /// location [m] and severity (and extent [m], if unknown) of each defect, for the largest number
  /// of defects of each kind: first the existing defects by location, then zeros.
  std::shared_ptr<OutsideModel> outside = {};
  /// Forward model that replaces the FE solution: predicts the lowest elastic frequencies [Hz], or
  /// modes if the case has shapes or correlated frequencies. The model must match the structure of
  /// the case. The case must not have an emulator.
  std::shared_ptr<const ForwardModel> model = {};
  /// Observations that are added to the data of the case
  std::vector<std::shared_ptr<const Observation>> observations = {};
};

/// Names of the inputs of an external model: "location[1]", "reduction[1]" …, preceded by the
/// kind's name if there are several kinds.
[[nodiscard]] std::vector<std::string> outside_inputs(const DamageCase& damage_case);

/// Completes the case, and trains or reads the emulator if the case requests an emulator. The log
/// likelihood is
///
///   Σ over measured modes of  -½ ((f_obs - f) / sd)² - ln(sd √2π),
///   sd² = (cv f_obs)² + σ²_emulator(θ) + (discrepancy f_obs)²,
///
/// where σ²_emulator is nonzero only if an emulator predicts and the case adds its error. If the
/// emulator only screens proposals ("exact"), this formula is the problem's likelihood `screen`,
/// and the problem's `likelihood` uses the FE solution.
///
/// The FE likelihood has a gradient. As a function of a location, the likelihood is piecewise
/// constant with zero derivative; the slopes of BeamModel replace this derivative by an ascent
/// direction. Emulators and external models have no gradient. External models are not assumed to be
/// mirror-symmetric. Throws InvalidInput, OutsideModelError.
[[nodiscard]] std::unique_ptr<const DamageProblem> make_damage_problem(
    DamageCase damage_case, const DamageProblemOptions& options);

}  // namespace wheeltap::identification
