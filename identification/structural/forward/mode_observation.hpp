// What measured modes, which are matched and not numbered, say of a structure with defects.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "identification/structural/forward/forward_model.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"

namespace wheeltap::identification {

/// Of one structure, or of several states of one. Immutable: threads share it, each with a solver
/// of its own, which refers to it.
class ModeObservation {
 public:
  virtual ~ModeObservation() = default;

  /// Modes of each state, and how the measured ones match them.
  struct Scored {
    std::vector<fem::ParametricModes::Modes> modes = {};
    ModalLikelihood::Score score = {};
  };

  class Solver {
   public:
    virtual ~Solver() = default;
    /// `theta`: of the intact structure, where it has parameters. False where there is no such
    /// structure.
    virtual bool score(std::span<const double> theta, const std::vector<PlacedDefect>& defects,
                       const ModalNoise& noise, Scored& out) = 0;
  };
  [[nodiscard]] virtual std::unique_ptr<Solver> make_solver() const = 0;

  /// All measured modes in a row.
  [[nodiscard]] virtual const ModalData& data() const = 0;
  [[nodiscard]] virtual int states() const = 0;
  [[nodiscard]] virtual const ModalLikelihood& of(int state) const = 0;
  /// The covariance [Hz²] of the measured frequencies; `with` says which modes of the row they are.
  [[nodiscard]] virtual Eigen::MatrixXd covariance(const Scored& scored, const ModalNoise& noise,
                                                   std::vector<int>& with) const = 0;
  /// Whether pieces of the structure err (StiffnessErrors), and ln p(a mode | all others, x) of
  /// each mode of the row where they do.
  [[nodiscard]] virtual bool with_errors(const ModalNoise& /*noise*/) const { return false; }
  [[nodiscard]] virtual Eigen::VectorXd single_mode_densities(const Scored& /*scored*/,
                                                              const ModalNoise& /*noise*/) const {
    return {};
  }
  /// As ForwardModel has it, at parameters of the intact structure that are no special place.
  [[nodiscard]] virtual ForwardModel::AllFrequencies all_frequencies() const = 0;
  /// Null, or the likelihood of several states.
  [[nodiscard]] virtual const StatesLikelihood* several_states() const { return nullptr; }
};

/// Modes of one structure, which `model` predicts at the sensors of `data`.
[[nodiscard]] std::shared_ptr<const ModeObservation> observe_structure(
    std::shared_ptr<const ForwardModel> model, const ModalData& data);

/// Modes of several states. Throws as StatesLikelihood does.
[[nodiscard]] std::shared_ptr<const ModeObservation> observe_states(
    std::shared_ptr<const ObservedStates> states, std::vector<DefectKind> kinds);

}  // namespace wheeltap::identification
