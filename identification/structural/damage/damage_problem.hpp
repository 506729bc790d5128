// From what is asked of a damaged beam to a problem for the engine: model space, likelihood and
// symmetries.
#pragma once

#include <functional>
#include <memory>

#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/damage/frequency_emulator.hpp"
#include "identification/structural/defects/site_symmetries.hpp"
#include "identification/structural/forward/program_model.hpp"
#include "identification/structural/problem/structural_problem.hpp"

namespace wheeltap::identification {

/// A damage case as a problem. Parameters that all models have: scatters, then those of the intact
/// structure, then the noise of observations that were added.
struct DamageProblem : StructuralProblem {
  DamageCase damage_case = {};
  std::shared_ptr<const FrequencyEmulator> emulator = {};  ///< before a forward model; or null
  std::shared_ptr<const ForwardModel> emulated = {};       ///< the two together; or null
  inference::LikelihoodFactory fe_likelihood = {};  ///< of the FE solution, whatever predicts
  /// The intact beam and the location priors equal their mirror images, and nothing that was
  /// measured tells them apart, as shapes do.
  bool symmetric = false;
  SiteSymmetries symmetries = {};  ///< of a structure, likewise
  int common = 0;                  ///< parameters that all models have
  /// Nothing predicts but the case's structure, and nothing was observed but the case's data.
  bool as_case = true;

  /// A program or a server predicts in place of the FE solution; or null.
  [[nodiscard]] const ProgramModel* program() const {
    return dynamic_cast<const ProgramModel*>(model.get());
  }

  using Component = PlacedDefect;
  /// The emulator screens proposals only.
  [[nodiscard]] bool exact() const { return emulator && damage_case.emulator->exact; }
  /// What the likelihood predicts with.
  [[nodiscard]] const ForwardModel& predicting() const {
    return emulated && !exact() ? *emulated : *model;
  }
  [[nodiscard]] NoiseModel noise() const { return NoiseModel(damage_case.data); }
};

struct DamageProblemOptions {
  int threads = 1;
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> table_progress = {};
  /// Predicts a beam's elastic frequencies [Hz] in place of the FE solution: from the place [m] and
  /// severity (and extent [m], where it is unknown) of each defect, of each kind as many as there
  /// may be at the most, those that there are first, in order of place, and then zeros.
  std::shared_ptr<OutsideModel> outside = {};
  /// Predicts in place of the FE solution: the lowest elastic frequencies [Hz], or modes where the
  /// case has shapes or correlated frequencies. It is trusted to know the case's structure, and
  /// goes without an emulator.
  std::shared_ptr<const ForwardModel> model = {};
  std::vector<std::shared_ptr<const Observation>> observations = {};  ///< beside the case's data
};

/// Inputs that such a model has, by name: "location[1]", "reduction[1]" …, with a kind's name
/// before where there are several.
[[nodiscard]] std::vector<std::string> outside_inputs(const DamageCase& damage_case);

/// Completes the case, and trains or reads the emulator where it asks for one. The log likelihood
/// is
///
///   Σ over measured modes of  -½ ((f_obs - f) / sd)² - ln(sd √2π),
///   sd² = (cv f_obs)² + σ²_emulator(θ) + (discrepancy f_obs)²,
///
/// the second term where an emulator predicts and its error is not switched off. Where the emulator
/// screens only ("exact"), this likelihood with it is the problem's `screen`, and its `likelihood`
/// is that of the FE solution.
///
/// The FE solution's likelihood offers its gradient, with slopes along places as BeamModel has
/// them: not the derivative of a likelihood that is piecewise constant in a damage's place, but
/// the way uphill. An emulator's offers none, nor does a model's of someone else's, whose mirror
/// images are not taken for the same. Throws InvalidInput, OutsideModelError.
[[nodiscard]] std::unique_ptr<const DamageProblem> make_damage_problem(
    DamageCase damage_case, const DamageProblemOptions& options);

}  // namespace wheeltap::identification
