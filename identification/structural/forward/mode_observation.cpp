#include "identification/structural/forward/mode_observation.hpp"

#include <cmath>

namespace wheeltap::identification {
namespace {

class OneStructure final : public ModeObservation {
 public:
  OneStructure(std::shared_ptr<const ForwardModel> model, const ModalData& data)
      : model_(std::move(model)), likelihood_(data) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override {
    return std::make_unique<OneSolver>(*this);
  }
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
  [[nodiscard]] ForwardModel::AllFrequencies all_frequencies() const override {
    return model_->all_frequencies();
  }

 private:
  class OneSolver final : public Solver {
   public:
    explicit OneSolver(const OneStructure& of) : of_(of), model_(of.model_->make_solver()) {}
    bool score(std::span<const double> /*theta*/, const std::vector<PlacedDefect>& defects,
               const ModalNoise& noise, Scored& out) override {
      out.modes.resize(1);
      if (!model_->modes(defects, out.modes[0])) return false;
      out.score = of_.likelihood_.score(out.modes[0], noise);
      return true;
    }

   private:
    const OneStructure& of_;
    std::unique_ptr<ForwardModel::Solver> model_;
  };

  std::shared_ptr<const ForwardModel> model_;
  ModalLikelihood likelihood_;
};

class SeveralStates final : public ModeObservation {
 public:
  SeveralStates(std::shared_ptr<const ObservedStates> states, std::vector<DefectKind> kinds)
      : likelihood_(std::move(states), std::move(kinds)) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override {
    return std::make_unique<StatesSolver>(likelihood_);
  }
  [[nodiscard]] const ModalData& data() const override { return likelihood_.data(); }
  [[nodiscard]] int states() const override {
    return static_cast<int>(likelihood_.states().list.size());
  }
  [[nodiscard]] const ModalLikelihood& of(int state) const override {
    return likelihood_.of(state);
  }
  [[nodiscard]] Eigen::MatrixXd covariance(const Scored& scored, const ModalNoise& noise,
                                           std::vector<int>& with) const override {
    return likelihood_.frequency_covariance(scored.modes, noise, scored.score, with);
  }
  [[nodiscard]] bool with_errors(const ModalNoise& noise) const override {
    return likelihood_.with_errors(noise);
  }
  [[nodiscard]] Eigen::VectorXd single_mode_densities(const Scored& scored,
                                                      const ModalNoise& noise) const override {
    return likelihood_.single_mode_densities(scored.modes, noise, scored.score);
  }
  [[nodiscard]] ForwardModel::AllFrequencies all_frequencies() const override {
    return [this](const std::vector<PlacedDefect>& defects) {
      return likelihood_.frequencies_anywhere(defects);
    };
  }
  [[nodiscard]] const StatesLikelihood* several_states() const override { return &likelihood_; }

 private:
  class StatesSolver final : public Solver {
   public:
    explicit StatesSolver(const StatesLikelihood& likelihood)
        : likelihood_(likelihood), workspace_(likelihood.make_workspace()) {}
    bool score(std::span<const double> theta, const std::vector<PlacedDefect>& defects,
               const ModalNoise& noise, Scored& out) override {
      if (!likelihood_.solve(theta, defects, workspace_, out.modes)) return false;
      out.score = likelihood_.score(out.modes, noise);
      return true;
    }

   private:
    const StatesLikelihood& likelihood_;
    StatesLikelihood::Workspace workspace_;
  };

  StatesLikelihood likelihood_;
};

}  // namespace

std::shared_ptr<const ModeObservation> observe_structure(std::shared_ptr<const ForwardModel> model,
                                                         const ModalData& data) {
  return std::make_shared<const OneStructure>(std::move(model), data);
}

std::shared_ptr<const ModeObservation> observe_states(std::shared_ptr<const ObservedStates> states,
                                                      std::vector<DefectKind> kinds) {
  return std::make_shared<const SeveralStates>(std::move(states), std::move(kinds));
}

}  // namespace wheeltap::identification
