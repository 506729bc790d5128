#include "identification/structural/forward/parametric_model.hpp"

#include <stdexcept>

namespace wheeltap::identification {
namespace {

class BasisSolver final : public ForwardModel::Solver {
 public:
  explicit BasisSolver(const fem::ParametricModes& basis)
      : basis_(basis), workspace_(basis.make_workspace()) {}

  bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& /*defects*/,
               ForwardModel::Quantity quantity, Prediction& out) override {
    if (quantity != ForwardModel::Quantity::modes) return false;
    out.modes.resize(1);
    fem::ParametricModes::Modes& modes = out.modes[0];
    try {
      basis_.solve(theta, workspace_, modes);
    } catch (const std::invalid_argument&) {
      return false;
    } catch (const std::runtime_error&) {
      return false;  // the solver does not converge near a mechanism
    }
    return modes.eigenvalues.allFinite() && modes.eigenvalues.minCoeff() > 0.0;
  }

  bool differentiate_modes(std::span<const double> theta, Prediction& out,
                           fem::ParametricModes::Slopes& slopes) override {
    out.modes.resize(1);
    try {
      return basis_.differentiate(theta, workspace_, out.modes[0], slopes);
    } catch (const std::exception&) {
      return false;
    }
  }

 private:
  const fem::ParametricModes& basis_;
  fem::ParametricModes::Workspace workspace_;
};

class OutsideModesSolver final : public ForwardModel::Solver {
 public:
  explicit OutsideModesSolver(const OutsidePredictor& predictor) : predictor_(predictor) {}

  bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& /*defects*/,
               ForwardModel::Quantity quantity, Prediction& out) override {
    if (quantity != ForwardModel::Quantity::modes) return false;
    if (predictor_.emulator && !predictor_.emulator->contains(theta)) return false;
    const auto outputs = static_cast<std::size_t>(predictor_.model->outputs());
    out.frequencies_hz.resize(outputs);
    out.error_variance.resize(outputs);
    predictor_.predict(theta, out.frequencies_hz, out.error_variance);
    if (!predictor_.emulator) out.error_variance.clear();
    out.modes.resize(1);
    Eigen::VectorXd& eigenvalues = out.modes[0].eigenvalues;
    eigenvalues.resize(static_cast<Eigen::Index>(outputs));
    for (std::size_t i = 0; i < outputs; ++i) {
      if (!(out.frequencies_hz[i] > 0.0)) return false;
      eigenvalues[static_cast<Eigen::Index>(i)] = eigenvalue_of(out.frequencies_hz[i]);
    }
    return true;
  }

  bool gradient(std::span<const double> theta, const ModalLikelihood& likelihood,
                const ModalNoise& noise, Prediction& out, std::span<double> slope) override {
    if (predictor_.emulator || !predict(theta, {}, ForwardModel::Quantity::modes, out))
      return false;
    return predictor_.model->gradient(theta, likelihood.pulls(out.modes[0], noise), slope);
  }

 private:
  const OutsidePredictor& predictor_;
};

}  // namespace

std::unique_ptr<ForwardModel::Solver> BasisModel::make_solver() const {
  return std::make_unique<BasisSolver>(*basis_);
}

std::unique_ptr<ForwardModel::Solver> OutsideModes::make_solver() const {
  return std::make_unique<OutsideModesSolver>(predictor_);
}

}  // namespace wheeltap::identification
