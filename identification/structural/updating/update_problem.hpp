// From a structure and its measured modes to a problem for the engine.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "identification/structural/forward/parametric_model.hpp"
#include "identification/structural/problem/structural_problem.hpp"
#include "identification/structural/updating/update_case.hpp"

namespace wheeltap::identification {

/// An update as a problem: one model, whose parameters are those of the structure and then, where
/// they are unknown, "cov", "shape_sd", "discrepancy", "shape_discrepancy" and "mixing", and the
/// noise of observations that were added.
struct UpdateProblem : StructuralProblem {
  UpdateCase update_case = {};
  double seconds_a_likelihood = 0.0;  ///< about, on this machine now

  /// Scatters of the state x, the emulator's error there included.
  [[nodiscard]] ModalNoise noise(std::span<const double> x) const;
  /// The reduced basis that predicts; null where something else does.
  [[nodiscard]] const fem::ParametricModes* basis() const {
    const auto* by = dynamic_cast<const BasisModel*>(model.get());
    return by == nullptr ? nullptr : &by->basis();
  }
  /// The program or server that predicts, likewise.
  [[nodiscard]] const OutsidePredictor* program() const {
    const auto* by = dynamic_cast<const OutsideModes*>(model.get());
    return by == nullptr ? nullptr : &by->predictor();
  }
};

struct UpdateProblemOptions {
  int training = 200;  ///< draws of the prior that the reduced basis is made for
  std::function<void(double)> progress = {};
  /// Predicts the frequencies [Hz] of the modes measured and of those to be foretold, from the
  /// parameters of the structure in their order; that structure is not looked at then.
  std::shared_ptr<OutsideModel> outside = {};
  std::optional<OutsideEmulatorSpec> emulator = {};  ///< in front of it
  int threads = 1;                                   ///< that train the emulator
  /// Predicts the modes at the case's sensors in place of the structure, which is not looked at.
  std::shared_ptr<const ForwardModel> model = {};
  std::vector<std::shared_ptr<const Observation>> observations = {};  ///< beside the case's data
};

/// Trains the reduced basis: eigenvalues are then known to a thousandth of the smallest scatter of
/// a frequency (1e-8 to 1e-5, relative), shapes to a fifth of theirs, or the structure is solved in
/// full. Throws std::invalid_argument for data that do not fit together and
/// more modes than there are, fem::InvalidStructure, OutsideModelError.
[[nodiscard]] std::unique_ptr<const UpdateProblem> make_update_problem(
    UpdateCase update_case, const UpdateProblemOptions& options = {});

}  // namespace wheeltap::identification
