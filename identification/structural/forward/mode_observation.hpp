// What measured modes, which are matched and not numbered, say of a structure.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "identification/structural/forward/observation.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"
#include "identification/structural/likelihood/unknown_scatters.hpp"

namespace wheeltap::identification {

/// Of one structure, or of several states of one.
class ModeObservation : public Observation {
 public:
  explicit ModeObservation(UnknownScatters scatters) : scatters_(std::move(scatters)) {}

  /// Modes of each state, and how the measured ones match them.
  struct Scored : Prediction {
    ModalLikelihood::Score score = {};
  };

  [[nodiscard]] const UnknownScatters& scatters() const { return scatters_; }
  [[nodiscard]] std::vector<inference::Parameter> parameters() const override {
    return scatters_.parameters();
  }
  double log_density(const Prediction& predicted, std::span<const double> noise,
                     inference::Evaluation& out) const override;
  /// The same with the errors of the prediction, where it has some, in place of those of `noise`.
  [[nodiscard]] ModalLikelihood::Score score(const Prediction& predicted, ModalNoise noise) const;

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
  /// Null, or the likelihood of several states.
  [[nodiscard]] virtual const StatesLikelihood* several_states() const { return nullptr; }

 private:
  [[nodiscard]] virtual ModalLikelihood::Score score_modes(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise) const = 0;

  UnknownScatters scatters_;
};

/// Modes of one structure. Throws as ModalLikelihood does.
[[nodiscard]] std::shared_ptr<const ModeObservation> observe_structure(const ModalData& data,
                                                                       UnknownScatters scatters);

/// Modes of several states.
[[nodiscard]] std::shared_ptr<const ModeObservation> observe_states(
    std::shared_ptr<const StatesLikelihood> likelihood, UnknownScatters scatters);

/// What predicts them.
class StatesModel final : public ForwardModel {
 public:
  explicit StatesModel(std::shared_ptr<const StatesLikelihood> states)
      : states_(std::move(states)) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;
  [[nodiscard]] AllFrequencies all_frequencies() const override;

 private:
  std::shared_ptr<const StatesLikelihood> states_;
};

}  // namespace wheeltap::identification
