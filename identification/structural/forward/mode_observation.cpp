#include "identification/structural/forward/mode_observation.hpp"

#include <cmath>

namespace wheeltap::identification {
namespace {

class OneStructure final : public ModeObservation {
 public:
  OneStructure(const ModalData& data, UnknownScatters scatters)
      : ModeObservation(std::move(scatters)), likelihood_(data) {}

  [[nodiscard]] const ModalData& data() const override { return likelihood_.data(); }
  [[nodiscard]] int states() const override { return 1; }
  [[nodiscard]] const ModalLikelihood& of(int /*state*/) const override { return likelihood_; }
  [[nodiscard]] Eigen::MatrixXd covariance(const Scored& /*scored*/, const ModalNoise& noise,
                                           std::vector<int>& with) const override {
    with.clear();
    for (int i = 0; i < data().modes(); ++i)
      if (!std::isnan(data().frequencies_hz[static_cast<std::size_t>(i)])) with.push_back(i);
    return likelihood_.covariance(noise)(with, with);
  }

 private:
  [[nodiscard]] ModalLikelihood::Score score_modes(
      const std::vector<fem::ParametricModes::Modes>& modes,
      const ModalNoise& noise) const override {
    return likelihood_.score(modes.front(), noise);
  }
  bool density_of_frequencies(const std::vector<fem::ParametricModes::Modes>& modes,
                              const ModalNoise& noise, double& log_density,
                              std::vector<double>& frequencies_hz) const override {
    log_density = 0.0;
    frequencies_hz.clear();
    return likelihood_.add_density_of_frequencies(modes.front(), noise, log_density,
                                                  frequencies_hz);
  }

  ModalLikelihood likelihood_;
};

class SeveralStates final : public ModeObservation {
 public:
  SeveralStates(std::shared_ptr<const StatesLikelihood> likelihood, UnknownScatters scatters)
      : ModeObservation(std::move(scatters)), likelihood_(std::move(likelihood)) {}

  [[nodiscard]] const ModalData& data() const override { return likelihood_->data(); }
  [[nodiscard]] int states() const override {
    return static_cast<int>(likelihood_->states().list.size());
  }
  [[nodiscard]] const ModalLikelihood& of(int state) const override {
    return likelihood_->of(state);
  }
  [[nodiscard]] Eigen::MatrixXd covariance(const Scored& scored, const ModalNoise& noise,
                                           std::vector<int>& with) const override {
    return likelihood_->frequency_covariance(scored.modes, noise, scored.score, with);
  }
  [[nodiscard]] bool with_errors(const ModalNoise& noise) const override {
    return likelihood_->with_errors(noise);
  }
  [[nodiscard]] Eigen::VectorXd single_mode_densities(const Scored& scored,
                                                      const ModalNoise& noise) const override {
    return likelihood_->single_mode_densities(scored.modes, noise, scored.score);
  }
  [[nodiscard]] const StatesLikelihood* several_states() const override {
    return likelihood_.get();
  }

 private:
  [[nodiscard]] ModalLikelihood::Score score_modes(
      const std::vector<fem::ParametricModes::Modes>& modes,
      const ModalNoise& noise) const override {
    return likelihood_->score(modes, noise);
  }
  bool density_of_frequencies(const std::vector<fem::ParametricModes::Modes>& modes,
                              const ModalNoise& noise, double& log_density,
                              std::vector<double>& frequencies_hz) const override {
    return likelihood_->density_of_frequencies(modes, noise, log_density, frequencies_hz);
  }

  std::shared_ptr<const StatesLikelihood> likelihood_;
};

class StatesSolver final : public ForwardModel::Solver {
 public:
  explicit StatesSolver(const StatesLikelihood& states)
      : states_(states), workspace_(states.make_workspace()) {}
  bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& defects,
               ForwardModel::Quantity quantity, Prediction& out) override {
    return quantity == ForwardModel::Quantity::modes &&
           states_.solve(theta, defects, workspace_, out.modes);
  }

 private:
  const StatesLikelihood& states_;
  StatesLikelihood::Workspace workspace_;
};

}  // namespace

double ModeObservation::log_density(const Prediction& predicted, std::span<const double> noise,
                                    inference::Evaluation& out) const {
  ModalNoise scatters = scatters_.noise(noise);
  if (!predicted.error_variance.empty()) scatters.emulator_variance = predicted.error_variance;
  double log_density = 0.0;
  if (density_of_frequencies(predicted.modes, scatters, log_density, out.prediction))
    return log_density;
  const ModalLikelihood::Score found = score_modes(predicted.modes, scatters);
  out.prediction.clear();
  for (const ModalLikelihood::Match& match : found.matches)
    out.prediction.push_back(match.frequency_hz);
  return found.log_likelihood;
}

ModalLikelihood::Score ModeObservation::score(const Prediction& predicted, ModalNoise noise) const {
  if (!predicted.error_variance.empty()) noise.emulator_variance = predicted.error_variance;
  return score_modes(predicted.modes, noise);
}

std::shared_ptr<const ModeObservation> observe_structure(const ModalData& data,
                                                         UnknownScatters scatters) {
  return std::make_shared<const OneStructure>(data, std::move(scatters));
}

std::shared_ptr<const ModeObservation> observe_states(
    std::shared_ptr<const StatesLikelihood> likelihood, UnknownScatters scatters) {
  return std::make_shared<const SeveralStates>(std::move(likelihood), std::move(scatters));
}

std::unique_ptr<ForwardModel::Solver> StatesModel::make_solver() const {
  return std::make_unique<StatesSolver>(*states_);
}

ForwardModel::AllFrequencies StatesModel::all_frequencies() const {
  return [this](const std::vector<PlacedDefect>& defects) {
    return states_->frequencies_anywhere(defects);
  };
}

}  // namespace wheeltap::identification
