// Conversion of a structure and its measured modes to an inference problem.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "identification/structural/forward/parametric_model.hpp"
#include "identification/structural/problem/structural_problem.hpp"
#include "identification/structural/updating/update_case.hpp"

namespace wheeltap::identification {

/// The inference problem of a model update, with one model. Order of the parameters: those of the
/// structure; the unknown noise parameters among "cov", "shape_sd", "discrepancy",
/// "shape_discrepancy" and "mixing"; the noise parameters of added observations.
struct UpdateProblem : StructuralProblem {
  UpdateCase update_case = {};
  double seconds_a_likelihood = 0.0;  ///< run time of a likelihood evaluation on this machine [s]

  /// Noise parameters at x, including the emulator's error variance at x.
  [[nodiscard]] ModalNoise noise(std::span<const double> x) const;
  /// The reduced basis that computes the predictions; null if another model computes them.
  [[nodiscard]] const fem::ParametricModes* basis() const {
    const auto* by = dynamic_cast<const BasisModel*>(model.get());
    return by == nullptr ? nullptr : &by->basis();
  }
  /// The external program or server that computes the predictions; null if another model computes
  /// them.
  [[nodiscard]] const OutsidePredictor* program() const {
    const auto* by = dynamic_cast<const OutsideModes*>(model.get());
    return by == nullptr ? nullptr : &by->predictor();
  }
};

struct UpdateProblemOptions {
  int training = 200;  ///< number of prior draws that train the basis
  std::function<void(double)> progress = {};
  /// External model that computes, from the parameters of the structure, the frequencies [Hz] of
  /// the measured modes, then those of the modes to predict. If set, the structure is not used.
  std::shared_ptr<OutsideModel> outside = {};
  std::optional<OutsideEmulatorSpec> emulator = {};  ///< emulates `outside`
  int threads = 1;                                   ///< number of threads that train the emulator
  /// Computes the modes at the case's sensors. If `model` is set, the structure is not used.
  std::shared_ptr<const ForwardModel> model = {};
  std::vector<std::shared_ptr<const Observation>> observations = {};  ///< further data
};

/// Makes the problem and trains the reduced basis. The relative error of eigenvalues is at most
/// 0.002 times the smallest relative sd of a frequency, limited to 1e-8 … 1e-5. The error of a
/// shape is at most a fifth of the smallest sd of a shape, limited to 1e-4 … 1e-2. If the basis is
/// less accurate, full solutions are used. Throws std::invalid_argument for inconsistent data and
/// for more modes than the structure has; throws fem::InvalidStructure, OutsideModelError.
[[nodiscard]] std::unique_ptr<const UpdateProblem> make_update_problem(
    UpdateCase update_case, const UpdateProblemOptions& options = {});

}  // namespace wheeltap::identification
