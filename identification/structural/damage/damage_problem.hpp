// Conversion of a damage case to a problem for the engine: model space, likelihood and symmetries.
#pragma once

#include <functional>
#include <memory>

#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/damage/frequency_emulator.hpp"
#include "identification/structural/defects/site_symmetries.hpp"
#include "identification/structural/forward/program_model.hpp"
#include "identification/structural/problem/structural_problem.hpp"

namespace wheeltap::identification {

/// A damage case as a problem. All models share these parameters, in this order: unknown noise
/// parameters, parameters of the intact structure, noise of added observations.
struct DamageProblem : StructuralProblem {
  DamageCase damage_case = {};
  std::shared_ptr<const FrequencyEmulator> emulator = {};  ///< emulator of a forward model, or null
  std::shared_ptr<const ForwardModel> emulated = {};       ///< the emulated forward model; or null
  /// Likelihood that always uses the FE solution
  inference::LikelihoodFactory fe_likelihood = {};
  /// True if the intact beam and the location priors are mirror-symmetric, and no data (such as
  /// shapes) distinguish the two sides.
  bool symmetric = false;
  SiteSymmetries symmetries = {};  ///< symmetries of a structure that no data break
  int common = 0;                  ///< number of parameters that all models share
  /// True if neither an external model nor a user's model predicts, and the only observations are
  /// the data of the case.
  bool as_case = true;

  /// The external program or server that replaces the FE solution, or null.
  [[nodiscard]] const ProgramModel* program() const {
    return dynamic_cast<const ProgramModel*>(model.get());
  }

  using Component = PlacedDefect;
  /// True if the emulator only screens proposals.
  [[nodiscard]] bool exact() const { return emulator && damage_case.emulator->exact; }
  /// The forward model that the likelihood uses.
  [[nodiscard]] const ForwardModel& predicting() const {
    return emulated && !exact() ? *emulated : *model;
  }
  [[nodiscard]] NoiseModel noise() const { return NoiseModel(damage_case.data); }
};

struct DamageProblemOptions {
  int threads = 1;
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> table_progress = {};
  /// Predicts a beam's elastic frequencies [Hz] instead of the FE solution. Inputs: place [m] and
  /// severity (and extent [m], if unknown) of each defect. Each kind has inputs for its largest
  /// count of defects: first the existing defects in order of place, then zeros.
  std::shared_ptr<OutsideModel> outside = {};
  /// Predicts the lowest elastic frequencies [Hz] instead of the FE solution, or modes if the case
  /// has shapes or correlated frequencies. This model must match the structure of the case; an
  /// emulator cannot replace it.
  std::shared_ptr<const ForwardModel> model = {};
  /// Observations in addition to the case's data
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
/// where σ²_emulator is zero unless an emulator predicts and its error is enabled. If the emulator
/// only screens proposals ("exact"), this is the problem's likelihood `screen`, and the problem's
/// `likelihood` uses the FE solution.
///
/// The FE likelihood has a gradient. The likelihood is piecewise constant in a location, so that
/// its derivative is zero. The slopes of BeamModel replace this derivative by an ascent direction.
/// Emulators and external models have no gradient. Wheeltap does not assume that an external model
/// is mirror-symmetric. Throws InvalidInput, OutsideModelError.
[[nodiscard]] std::unique_ptr<const DamageProblem> make_damage_problem(
    DamageCase damage_case, const DamageProblemOptions& options);

}  // namespace wheeltap::identification
