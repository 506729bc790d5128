// From what is asked of a damaged beam to a problem for the engine: model space, likelihood and
// symmetries.
#pragma once

#include <functional>
#include <memory>
#include <variant>

#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/damage/frequency_emulator.hpp"
#include "identification/structural/defects/site_symmetries.hpp"
#include "identification/structural/forward/forward_model.hpp"
#include "identification/structural/forward/mode_observation.hpp"
#include "identification/structural/forward/program_model.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// All that a run needs, kept together because the problem's likelihood refers to it.
struct DamageProblem {
  DamageCase damage_case;
  /// Of frequencies, which are numbered: what predicts them. Of modes, which are matched: what they
  /// say.
  using Numbered = std::shared_ptr<const ForwardModel>;
  using Matched = std::shared_ptr<const ModeObservation>;
  std::variant<Numbered, Matched> observed = {};
  std::shared_ptr<const FrequencyEmulator> emulator = {};  ///< before a forward model; or null
  inference::Problem problem;
  inference::LikelihoodFactory fe_likelihood;  ///< of the FE solution, whatever predicts
  /// The intact beam and the location priors equal their mirror images, and nothing that was
  /// measured tells them apart, as shapes do.
  bool symmetric = false;
  SiteSymmetries symmetries = {};  ///< of a structure, likewise
  int common = 0;    ///< parameters that all models have: scatters, then the intact structure's
  int scatters = 0;  ///< of these, inferred scatters

  /// Modes are matched, and not numbered.
  [[nodiscard]] bool by_modes() const { return std::holds_alternative<Matched>(observed); }
  /// Throw std::bad_variant_access of the other sort of problem.
  [[nodiscard]] const ForwardModel& forward() const { return *std::get<Numbered>(observed); }
  [[nodiscard]] const ModeObservation& modes() const { return *std::get<Matched>(observed); }
  /// Of modes in several states; or null.
  [[nodiscard]] const StatesLikelihood* states() const {
    return by_modes() ? modes().several_states() : nullptr;
  }
  /// A program or a server predicts in place of the FE solution; or null.
  [[nodiscard]] const ProgramModel* program() const {
    return by_modes() ? nullptr : dynamic_cast<const ProgramModel*>(&forward());
  }

  /// The components of a parameter vector of `model`, in the order of kinds.
  using Component = PlacedDefect;
  [[nodiscard]] std::vector<Component> components(int model, std::span<const double> x) const;
  /// The same, in place of what `to` held.
  void components(int model, std::span<const double> x, std::vector<Component>& to) const;

  /// The emulator screens proposals only.
  [[nodiscard]] bool exact() const { return emulator && damage_case.emulator->exact; }
  [[nodiscard]] NoiseModel noise() const { return NoiseModel(damage_case.data); }
  /// The scatters that a state of a problem with shapes has.
  [[nodiscard]] ModalNoise modal_noise(std::span<const double> x) const;
};

/// Frequencies [Hz] of a state, for one thread.
class FrequencyPredictor {
 public:
  explicit FrequencyPredictor(const DamageProblem& problem);
  /// By the FE solution; the `out.size()` lowest elastic ones, or those that match the measured
  /// modes. ∞ where there is no such structure.
  void solve(int model, std::span<const double> x, std::span<double> out);
  /// What the data say of a state of a problem `by_modes`. False where there is no such structure.
  bool score(int model, std::span<const double> x, ModeObservation::Scored& out);
  /// By the problem's emulator, with the variances [Hz²] of its error (0 where the case switches
  /// them off). Without damages, and where ANOVA's sum is no frequency, by the FE solution.
  void emulate(int model, std::span<const double> x, std::span<double> out,
               std::span<double> variance);
  /// As `solve`, with ∂f/∂x in the units of x: `jacobian` is row-major, a row a frequency, a column
  /// a parameter of the model. False, and nothing done, where the forward model has no slopes.
  bool differentiate(int model, std::span<const double> x, std::span<double> out,
                     std::span<double> jacobian);

 private:
  void place(int model, std::span<const double> x);
  void solve_placed(std::span<double> out);

  const DamageProblem& problem_;
  std::unique_ptr<ForwardModel::Solver> solver_;          // of numbered frequencies
  std::unique_ptr<ModeObservation::Solver> mode_solver_;  // of modes that are matched
  std::vector<PlacedDefect> defects_;
  ForwardModel::Slopes slopes_;
  fem::Defects placed_;
};

struct DamageProblemOptions {
  int threads = 1;
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> table_progress = {};
  /// Predicts a beam's elastic frequencies [Hz] in place of the FE solution: from the place [m] and
  /// severity (and extent [m], where it is unknown) of each defect, of each kind as many as there
  /// may be at the most, those that there are first, in order of place, and then zeros.
  std::shared_ptr<OutsideModel> outside = {};
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
/// The FE solution's likelihood offers its gradient, with slopes along places as FrequencyPredictor
/// has them: not the derivative of a likelihood that is piecewise constant in a damage's place, but
/// the way uphill. An emulator's offers none, nor does a model's of someone else's, whose mirror
/// images are not taken for the same. Throws InvalidInput, OutsideModelError.
[[nodiscard]] std::unique_ptr<const DamageProblem> make_damage_problem(
    DamageCase damage_case, const DamageProblemOptions& options);

}  // namespace wheeltap::identification
