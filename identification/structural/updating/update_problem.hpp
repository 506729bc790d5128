// From a structure and its measured modes to a problem for the engine.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/emulation/outside_predictor.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"
#include "identification/structural/updating/update_case.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// All that a run needs, kept together because the problem's likelihood refers to it. One model,
/// whose parameters are those of the structure and then, where they are unknown, "cov",
/// "shape_sd", "discrepancy", "shape_discrepancy" and "mixing".
struct UpdateProblem {
  UpdateCase update_case;
  /// Modes of one structure, by a reduced basis of them.
  struct ByBasis {
    std::shared_ptr<const fem::ParametricModes> modes;
    std::shared_ptr<const ModalLikelihood> likelihood;
  };
  /// Modes of several states of one.
  struct ByStates {
    std::shared_ptr<const StatesLikelihood> likelihood;
  };
  /// Frequencies, by a program or a server.
  struct ByProgram {
    std::shared_ptr<const OutsidePredictor> predictor;
    std::shared_ptr<const ModalLikelihood> likelihood;
  };
  std::variant<ByBasis, ByStates, ByProgram> solution = {};
  inference::Problem problem;
  int structural = 0;  ///< parameters of the structure
  /// Where the scatters stand in a parameter vector; -1: known.
  int cov = -1, shape_sd = -1, discrepancy = -1, shape_discrepancy = -1, mixing = -1;
  double seconds_a_likelihood = 0.0;  ///< about, on this machine now

  /// Of the state x, the emulator's error there included.
  [[nodiscard]] ModalNoise noise(std::span<const double> x) const;
  /// Without it.
  [[nodiscard]] ModalNoise scatters(std::span<const double> x) const;
  [[nodiscard]] std::span<const double> theta(std::span<const double> x) const {
    return x.first(static_cast<std::size_t>(structural));
  }
  /// Each null where the solution is another.
  [[nodiscard]] const fem::ParametricModes* basis() const {
    const auto* by = std::get_if<ByBasis>(&solution);
    return by == nullptr ? nullptr : by->modes.get();
  }
  [[nodiscard]] const StatesLikelihood* states() const {
    const auto* by = std::get_if<ByStates>(&solution);
    return by == nullptr ? nullptr : by->likelihood.get();
  }
  [[nodiscard]] const OutsidePredictor* program() const {
    const auto* by = std::get_if<ByProgram>(&solution);
    return by == nullptr ? nullptr : by->predictor.get();
  }
  /// Of one structure's modes. Throws std::bad_variant_access where there are several states.
  [[nodiscard]] const ModalLikelihood& likelihood() const {
    const auto* by = std::get_if<ByBasis>(&solution);
    return by == nullptr ? *std::get<ByProgram>(solution).likelihood : *by->likelihood;
  }
  /// The lowest elastic modes that are computed, to be predicted.
  [[nodiscard]] int candidates() const {
    return basis() != nullptr     ? basis()->modes()
           : program() != nullptr ? program()->model->outputs()
                                  : 0;
  }
  [[nodiscard]] Eigen::MatrixXd covariance(const ModalNoise& noise) const {
    return states() != nullptr ? states()->covariance(noise) : likelihood().covariance(noise);
  }
  [[nodiscard]] const std::optional<ShapeDensity>& shape(int mode) const {
    if (states() == nullptr) return likelihood().shape(mode);
    const auto at = states()->place(mode);
    return states()->of(at.state).shape(at.mode);
  }
  [[nodiscard]] int measured() const {
    return states() != nullptr ? states()->measured() : likelihood().measured();
  }
};

/// Names that scatters have as parameters.
[[nodiscard]] const std::vector<std::string>& scatter_names();

struct UpdateProblemOptions {
  int training = 200;  ///< draws of the prior that the reduced basis is made for
  std::function<void(double)> progress = {};
  /// Predicts the frequencies [Hz] of the modes measured and of those to be foretold, from the
  /// parameters of the structure in their order; that structure is not looked at then.
  std::shared_ptr<OutsideModel> outside = {};
  std::optional<OutsideEmulatorSpec> emulator = {};  ///< in front of it
  int threads = 1;                                   ///< that train the emulator
};

/// Trains the reduced basis: eigenvalues are then known to a thousandth of the smallest scatter of
/// a frequency (1e-8 to 1e-5, relative), shapes to a fifth of theirs, or the structure is solved in
/// full. Throws std::invalid_argument for data that do not fit together and
/// more modes than there are, fem::InvalidStructure, OutsideModelError.
[[nodiscard]] std::unique_ptr<const UpdateProblem> make_update_problem(
    UpdateCase update_case, const UpdateProblemOptions& options = {});

/// Modes of a state, for one thread.
class ModePredictor {
 public:
  explicit ModePredictor(const UpdateProblem& problem);
  /// False where there is no such structure.
  bool solve(std::span<const double> x);
  [[nodiscard]] const fem::ParametricModes::Modes& modes() const { return modes_; }
  [[nodiscard]] ModalLikelihood::Score score(std::span<const double> x) const;
  /// ∂ ln p/∂x. False where there is none.
  bool gradient(std::span<const double> x, std::span<double> out);

 private:
  bool ask_outside(std::span<const double> x);

  const UpdateProblem& problem_;
  std::vector<double> frequencies_hz_, variance_;
  std::optional<fem::ParametricModes::Workspace> workspace_;
  std::vector<fem::ParametricModes::Modes> of_states_;
  StatesLikelihood::Workspace states_workspace_ = {};
  fem::ParametricModes::Modes modes_;
  fem::ParametricModes::Slopes slopes_;
};

}  // namespace wheeltap::identification
