// From what is asked of a damaged beam to a problem for the engine: model space, likelihood and
// symmetries.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "identification/emulation/outside_model.hpp"
#include "identification/structural/damage/damage_case.hpp"
#include "identification/structural/damage/frequency_emulator.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/defects/site_symmetries.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// All that a run needs, kept together because the problem's likelihood refers to it.
struct DamageProblem {
  DamageCase damage_case;
  std::shared_ptr<const fem::Reanalysis> reanalysis;  ///< of a beam
  std::shared_ptr<const fem::StructureReanalysis> structure = {};
  std::shared_ptr<const fem::Mesh> mesh = {};  ///< of a structure of members
  std::shared_ptr<const FrequencyEmulator>
      emulator;  ///< null where the FE solution itself predicts
  std::shared_ptr<const ModalLikelihood> modal = {};    ///< of shapes, where there are any
  std::shared_ptr<const StatesLikelihood> states = {};  ///< in place of all these
  std::shared_ptr<OutsideModel> outside = {};           ///< in place of the FE solution
  inference::Problem problem;
  inference::LikelihoodFactory fe_likelihood;  ///< of the FE solution, whatever predicts
  /// The intact beam and the location priors equal their mirror images, and nothing that was
  /// measured tells them apart, as shapes do.
  bool symmetric = false;
  SiteSymmetries symmetries = {};  ///< of a structure, likewise
  int common = 0;    ///< parameters that all models have: scatters, then the intact structure's
  int scatters = 0;  ///< of these, inferred scatters

  /// Modes are matched, and not numbered.
  [[nodiscard]] bool by_modes() const { return modal || states; }

  /// The components of a parameter vector of `model`, in the order of kinds.
  struct Component {
    int kind;
    double location;
    double severity;      ///< reduction, or stiffness (∞: rigid)
    double extent = 0.0;  ///< [m], where it is unknown
  };
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
  /// By the FE solution; the `out.size()` lowest elastic ones.
  void solve(int model, std::span<const double> x, std::span<double> out);
  /// Elastic modes of a problem with shapes, at its sensors. False where there is no such
  /// structure.
  bool solve_modes(int model, std::span<const double> x, fem::ParametricModes::Modes& out);
  /// What the data say of a state of a problem `by_modes`. False where there is no such structure.
  bool score(int model, std::span<const double> x, ModalLikelihood::Score& out);
  /// Of the state that was scored last: the covariance [Hz²] of the measured frequencies, which
  /// these are, and the modes of a state of the structure (0 where there is but one).
  [[nodiscard]] Eigen::MatrixXd covariance(std::span<const double> x,
                                           const ModalLikelihood::Score& score,
                                           std::vector<int>& with) const;
  /// Whether pieces of the structure err (StiffnessErrors); and ln p(a mode | all others, x) of
  /// what was scored last, where they do.
  [[nodiscard]] bool with_errors(std::span<const double> x) const;
  [[nodiscard]] Eigen::VectorXd single_mode_densities(std::span<const double> x,
                                                      const ModalLikelihood::Score& score) const;
  [[nodiscard]] const fem::ParametricModes::Modes& scored_modes(int state) const {
    return problem_.states ? of_states_[static_cast<std::size_t>(state)] : modes_;
  }
  /// By the problem's emulator, with the variances [Hz²] of its error (0 where the case switches
  /// them off). Without damages, and where ANOVA's sum is no frequency, by the FE solution.
  void emulate(int model, std::span<const double> x, std::span<double> out,
               std::span<double> variance);
  /// As `solve`, with ∂f/∂x in the units of x: `jacobian` is row-major, a row a frequency, a column
  /// a parameter of the model. Exact in reductions and stiffnesses; along places it is
  /// fem::Reanalysis::location_slopes, at two more solutions each. False, and nothing done, where a
  /// kind of defect is not elementary.
  bool differentiate(int model, std::span<const double> x, std::span<double> out,
                     std::span<double> jacobian);

 private:
  void place(int model, std::span<const double> x);
  void solve_placed(std::span<double> out);
  [[nodiscard]] std::size_t first_elastic() const;

  /// False where there is no such structure.
  bool solve_changed(int model, std::span<const double> x,
                     const fem::StructureReanalysis::Results& results);
  void solve_structure(int model, std::span<const double> x, std::span<double> out);
  void ask_outside(int model, std::span<const double> x, std::span<double> out);

  const DamageProblem& problem_;
  std::optional<fem::Reanalysis::Workspace> workspace_;
  std::optional<fem::StructureReanalysis::Workspace> structure_workspace_;
  std::vector<PlacedDefect> in_structure_;
  fem::ParametricModes::Modes modes_;
  std::vector<fem::ParametricModes::Modes> of_states_;
  StatesLikelihood::Workspace states_workspace_ = {};
  std::size_t rigid_;
  std::vector<double> all_, shapes_;
  std::vector<fem::SparseRow> motions_;
  fem::Defects placed_;
  std::vector<double> by_reduction_, by_stiffness_, along_damages_, along_supports_;
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
