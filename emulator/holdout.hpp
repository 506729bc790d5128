// Error of an emulator, measured on new runs of the model.
#pragma once

#include "emulator/experiment.hpp"

namespace wheeltap::emulator {

/// Error of one response over n held-out runs, with y the model and ŷ the emulator.
struct HoldoutError {
  double rmse;       ///< √(Σ (ŷ - y)² / n), in the response's unit
  double max_error;  ///< max |ŷ - y|
  double spread;     ///< √(Σ (y - ȳ)² / n): standard deviation of the response
  double q2;  ///< predictive coefficient Q² = 1 - Σ (ŷ-y)² / Σ (y-ȳ)² = 1 - (rmse/spread)²

  /// rmse / spread: 0 is exact, 1 equals predicting the mean.
  [[nodiscard]] double relative_rmse() const { return spread > 0 ? rmse / spread : 0.0; }
  /// True if Q² < 0.9, i.e. rmse/spread > 0.32. The error is then at least a third of the standard
  /// deviation of the response. Two points whose responses differ by one standard deviation of the
  /// response cannot be distinguished at two to three standard errors. Sensitivity studies also
  /// require Q² ≥ 0.9 of metamodels.
  [[nodiscard]] bool cannot_be_predicted() const { return !(q2 >= 0.9); }
  [[nodiscard]] bool operator==(const HoldoutError&) const = default;
};

/// Computes the errors of each response from the model's values and the predictions (runs ×
/// responses each). If a response does not vary, Q² is 1 for an error within rounding (1e-12 of its
/// size) and -∞ otherwise. Throws std::invalid_argument unless both have the same shape and at
/// least two runs.
[[nodiscard]] std::vector<HoldoutError> holdout_error(const RowMatrix& truth,
                                                      const RowMatrix& predicted);

/// Calibration of a response's predicted variances, by z = (y - ŷ) / √variance over n runs.
struct StandardisedResiduals {
  double mean;        ///< 0 for an unbiased predictor
  double rms;         ///< 1 for calibrated variances; above: overconfident
  double beyond_two;  ///< share with |z| > 2: 0.046 for a normal error
};

/// Statistics per response, from runs × responses each, for held-out runs or leave-one-out
/// predictions. Runs with variance 0 and an exact prediction are omitted; with variance 0 and an
/// error, rms is infinite. Throws std::invalid_argument for different shapes or no runs.
[[nodiscard]] std::vector<StandardisedResiduals> standardised_residuals(const RowMatrix& truth,
                                                                        const RowMatrix& mean,
                                                                        const RowMatrix& variance);

/// A function with a model's interface, such as an emulator's evaluate().
using Predictor = std::function<void(std::span<const double> point, std::span<double> response)>;

/// The predictions at every point of a design: runs × responses.
[[nodiscard]] RowMatrix predict(const Predictor& predictor, const Design& design,
                                Eigen::Index responses);

struct HoldoutOptions {
  Eigen::Index runs = 200;  ///< fresh runs of the model, >= 2
  std::uint64_t seed = 1;   ///< for the points
  ExperimentOptions experiment = {};
};

/// Runs the model at uniform random points in the box of the factors' ranges and compares the
/// emulator with it. Throws the exceptions of run_experiment, and std::invalid_argument for fewer
/// than two runs.
[[nodiscard]] std::vector<HoldoutError> validate(const std::vector<Factor>& factors,
                                                 Eigen::Index responses,
                                                 const ModelFactory& factory,
                                                 const Predictor& predictor,
                                                 const HoldoutOptions& options = {});

}  // namespace wheeltap::emulator
