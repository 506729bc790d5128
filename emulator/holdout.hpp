// The error of an emulator, measured on new runs of the model.
#pragma once

#include "emulator/experiment.hpp"

namespace wheeltap::emulator {

/// Error of one response over n held-out runs, with the model response y and the emulator
/// prediction ŷ.
struct HoldoutError {
  double rmse;       ///< root mean square error √(Σ (ŷ - y)² / n), in the response's unit
  double max_error;  ///< max |ŷ - y|
  double spread;     ///< √(Σ (y - ȳ)² / n): standard deviation of the response
  double q2;  ///< predictive coefficient Q² = 1 - Σ (ŷ-y)² / Σ (y-ȳ)² = 1 - (rmse/spread)²

  /// Returns rmse / spread: 0 for an exact emulator, 1 for a prediction by the mean.
  [[nodiscard]] double relative_rmse() const { return spread > 0 ? rmse / spread : 0.0; }
  /// True if Q² < 0.9, that is rmse/spread > 0.32. The RMS error is then about a third of the
  /// standard deviation of the response, or more. If two responses differ by one standard deviation
  /// of the response, the difference is then only two to three standard errors of the emulator.
  /// Sensitivity studies also require emulators with Q² ≥ 0.9.
  [[nodiscard]] bool cannot_be_predicted() const { return !(q2 >= 0.9); }
  [[nodiscard]] bool operator==(const HoldoutError&) const = default;
};

/// Computes the errors of each response from the model's values and the predictions (runs ×
/// responses each). If a response has the same value in all runs, Q² is 1 for a rounding error (at
/// most 1e-12 of the response) and -∞ for a larger error. Throws std::invalid_argument unless both
/// matrices have the same size and at least two runs.
[[nodiscard]] std::vector<HoldoutError> holdout_error(const RowMatrix& truth,
                                                      const RowMatrix& predicted);

/// Calibration of the predicted variances of a response: statistics of z = (y - ŷ) / √variance over
/// n runs.
struct StandardisedResiduals {
  double mean;        ///< mean of z; 0 for an unbiased predictor
  double rms;         ///< root mean square of z; 1 for calibrated variances, above 1 for variances
                      ///< that are too small
  double beyond_two;  ///< fraction of runs with |z| > 2; 0.046 for a normal error
};

/// Computes the statistics of each response from matrices of runs × responses, for held-out runs or
/// leave-one-out predictions. Runs with variance 0 and an exact prediction are omitted. If a run
/// has variance 0 and a nonzero error, rms is infinite. Throws std::invalid_argument for matrices
/// of different sizes or without runs.
[[nodiscard]] std::vector<StandardisedResiduals> standardised_residuals(const RowMatrix& truth,
                                                                        const RowMatrix& mean,
                                                                        const RowMatrix& variance);

/// A function with the interface of a model, for example the function `evaluate` of an emulator.
using Predictor = std::function<void(std::span<const double> point, std::span<double> response)>;

/// Computes the predictions at every point of a design, as a matrix of runs × responses.
[[nodiscard]] RowMatrix predict(const Predictor& predictor, const Design& design,
                                Eigen::Index responses);

struct HoldoutOptions {
  Eigen::Index runs = 200;  ///< number of new model runs, >= 2
  std::uint64_t seed = 1;   ///< seed for the points
  ExperimentOptions experiment = {};
};

/// Runs the model at uniform random points in the box of the factors' ranges, and compares the
/// predictions of the emulator with these runs. Throws the exceptions of run_experiment, and
/// std::invalid_argument for fewer than two runs.
[[nodiscard]] std::vector<HoldoutError> validate(const std::vector<Factor>& factors,
                                                 Eigen::Index responses,
                                                 const ModelFactory& factory,
                                                 const Predictor& predictor,
                                                 const HoldoutOptions& options = {});

}  // namespace wheeltap::emulator
