// Observation of measured modes, which are matched to computed modes by their shapes and
// frequencies instead of by mode number.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "identification/structural/forward/observation.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"
#include "identification/structural/likelihood/unknown_scatters.hpp"

namespace wheeltap::identification {

/// Measured modes of a structure in one state or in several states.
class ModeObservation : public Observation {
 public:
  explicit ModeObservation(UnknownScatters scatters) : scatters_(std::move(scatters)) {}

  /// Computed modes of each state, and their matching with the measured modes.
  struct Scored : Prediction {
    ModalLikelihood::Score score = {};
  };

  [[nodiscard]] const UnknownScatters& scatters() const { return scatters_; }
  [[nodiscard]] std::vector<inference::Parameter> parameters() const override {
    return scatters_.parameters();
  }
  double log_density(const Prediction& predicted, std::span<const double> noise,
                     inference::Evaluation& out) const override;
  /// Computes the score (log likelihood and matching) of modes that are already predicted. If the
  /// prediction has error variances, these replace the error variances of `noise`.
  [[nodiscard]] ModalLikelihood::Score score(const Prediction& predicted, ModalNoise noise) const;

  /// The measured modes of all states, concatenated.
  [[nodiscard]] virtual const ModalData& data() const = 0;
  [[nodiscard]] virtual int states() const = 0;
  [[nodiscard]] virtual const ModalLikelihood& of(int state) const = 0;
  /// Covariance [Hz²] of the measured frequencies; `with` receives the indices of these frequencies
  /// in `data`.
  [[nodiscard]] virtual Eigen::MatrixXd covariance(const Scored& scored, const ModalNoise& noise,
                                                   std::vector<int>& with) const = 0;
  /// True if stiffness errors are included (StiffnessErrors). In this case, `single_mode_densities`
  /// gives ln p(mode | all other modes, x) for each mode of `data`.
  [[nodiscard]] virtual bool with_errors(const ModalNoise& /*noise*/) const { return false; }
  [[nodiscard]] virtual Eigen::VectorXd single_mode_densities(const Scored& /*scored*/,
                                                              const ModalNoise& /*noise*/) const {
    return {};
  }
  /// The likelihood of several states; null for one state.
  [[nodiscard]] virtual const StatesLikelihood* several_states() const { return nullptr; }

 private:
  [[nodiscard]] virtual ModalLikelihood::Score score_modes(
      const std::vector<fem::ParametricModes::Modes>& modes, const ModalNoise& noise) const = 0;
  /// As StatesLikelihood::density_of_frequencies.
  virtual bool density_of_frequencies(const std::vector<fem::ParametricModes::Modes>& modes,
                                      const ModalNoise& noise, double& log_density,
                                      std::vector<double>& frequencies_hz) const = 0;

  UnknownScatters scatters_;
};

/// Creates the ModeObservation of the modes of one structure. Throws the exceptions of
/// ModalLikelihood.
[[nodiscard]] std::shared_ptr<const ModeObservation> observe_structure(const ModalData& data,
                                                                       UnknownScatters scatters);

/// Creates the ModeObservation of the modes of several states.
[[nodiscard]] std::shared_ptr<const ModeObservation> observe_states(
    std::shared_ptr<const StatesLikelihood> likelihood, UnknownScatters scatters);

/// The forward model of several states.
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
