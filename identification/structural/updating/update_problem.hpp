// Conversion of a structure and its measured modes to a problem for the engine.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "identification/structural/forward/parametric_model.hpp"
#include "identification/structural/problem/structural_problem.hpp"
#include "identification/structural/updating/update_case.hpp"

namespace wheeltap::identification {

/// An update as a problem with one model. Order of its parameters: those of the structure; the
/// unknown noise parameters among "cov", "shape_sd", "discrepancy", "shape_discrepancy" and
/// "mixing"; the noise parameters of added observations.
struct UpdateProblem : StructuralProblem {
  UpdateCase update_case = {};
  double seconds_a_likelihood = 0.0;  ///< estimate for this machine [s]

  /// Noise parameters at x, with the emulator's error at x.
  [[nodiscard]] ModalNoise noise(std::span<const double> x) const;
  /// The reduced basis that predicts; null if another model predicts.
  [[nodiscard]] const fem::ParametricModes* basis() const {
    const auto* by = dynamic_cast<const BasisModel*>(model.get());
    return by == nullptr ? nullptr : &by->basis();
  }
  /// The external program or server that predicts; null if another model predicts.
  [[nodiscard]] const OutsidePredictor* program() const {
    const auto* by = dynamic_cast<const OutsideModes*>(model.get());
    return by == nullptr ? nullptr : &by->predictor();
  }
};

struct UpdateProblemOptions {
  int training = 200;  ///< prior draws that train the reduced basis
  std::function<void(double)> progress = {};
  /// Predicts the frequencies [Hz] of the measured modes and of the modes to be predicted, from the
  /// parameters of the structure in their order. If `outside` is set, the structure is not used.
  std::shared_ptr<OutsideModel> outside = {};
  std::optional<OutsideEmulatorSpec> emulator = {};  ///< emulates `outside`
  int threads = 1;                                   ///< number of threads that train the emulator
  /// Predicts the modes at the case's sensors. If `model` is set, the structure is not used.
  std::shared_ptr<const ForwardModel> model = {};
  std::vector<std::shared_ptr<const Observation>> observations = {};  ///< in addition to the data
};

/// Makes the problem and trains the reduced basis. The relative error of eigenvalues is at most a
/// thousandth of the smallest standard deviation of a frequency (between 1e-8 and 1e-5). The error
/// of shapes is at most a fifth of their standard deviation. If the basis is less accurate, full
/// solutions replace it. Throws std::invalid_argument for inconsistent data and for more modes than
/// the structure has; throws fem::InvalidStructure, OutsideModelError.
[[nodiscard]] std::unique_ptr<const UpdateProblem> make_update_problem(
    UpdateCase update_case, const UpdateProblemOptions& options = {});

}  // namespace wheeltap::identification
