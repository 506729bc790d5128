// How wrong an emulator is, measured on runs of the model that it has not seen.
#pragma once

#include "emulator/experiment.hpp"

namespace wheeltap::emulator {

/// Error of one response over n held-out runs, with y the model and ŷ the emulator.
struct HoldoutError {
  double rmse;       ///< √(Σ (ŷ - y)² / n), in the response's unit
  double max_error;  ///< max |ŷ - y|
  double spread;     ///< √(Σ (y - ȳ)² / n): how much the factors move the response
  double q2;  ///< predictive coefficient Q² = 1 - Σ (ŷ-y)² / Σ (y-ȳ)² = 1 - (rmse/spread)²

  /// rmse / spread: 0 is perfect, 1 no better than predicting the mean.
  [[nodiscard]] double relative_rmse() const { return spread > 0 ? rmse / spread : 0.0; }
  /// True where Q² < 0.9, that is rmse/spread > 0.32: the error is then a third or more of the
  /// whole effect that the response is meant to reveal, and two designs a standard deviation of the
  /// effect apart are no longer told apart at two to three sigma. A usual bound for metamodels in
  /// sensitivity studies is Q² ≥ 0.9 as well.
  [[nodiscard]] bool cannot_be_predicted() const { return !(q2 >= 0.9); }
  [[nodiscard]] bool operator==(const HoldoutError&) const = default;
};

/// Per response, from truth and prediction (runs × responses each). Where a response does not vary,
/// Q² is 1 for an error within rounding (1e-12 of its size) and -∞ otherwise. Throws
/// std::invalid_argument unless both have the same shape and at least two runs.
[[nodiscard]] std::vector<HoldoutError> holdout_error(const RowMatrix& truth,
                                                      const RowMatrix& predicted);

/// Whether a response's predicted variances are honest: of z = (y - ŷ) / √variance over n runs.
struct StandardisedResiduals {
  double mean;        ///< 0 for an unbiased predictor
  double rms;         ///< 1 for honest variances; above: overconfident
  double beyond_two;  ///< share with |z| > 2: 0.046 for a normal error
};

/// Per response, from runs × responses each; for held-out runs or leave-one-out predictions alike.
/// Runs predicted exactly with variance 0 are left out; an error at variance 0 makes rms infinite.
/// Throws std::invalid_argument for different shapes or no runs.
[[nodiscard]] std::vector<StandardisedResiduals> standardised_residuals(const RowMatrix& truth,
                                                                        const RowMatrix& mean,
                                                                        const RowMatrix& variance);

/// Something that answers like a model: an emulator bound to its evaluate().
using Predictor = std::function<void(std::span<const double> point, std::span<double> response)>;

/// The predictor's answers at every point of a design: runs × responses.
[[nodiscard]] RowMatrix predict(const Predictor& predictor, const Design& design,
                                Eigen::Index responses);

struct HoldoutOptions {
  Eigen::Index runs = 200;  ///< fresh runs of the model, >= 2
  std::uint64_t seed = 1;   ///< of the points
  ExperimentOptions experiment = {};
};

/// Runs the model at points uniform in the box of the factors' ranges and compares.
/// Throws as run_experiment does, and std::invalid_argument for fewer than two runs.
[[nodiscard]] std::vector<HoldoutError> validate(const std::vector<Factor>& factors,
                                                 Eigen::Index responses,
                                                 const ModelFactory& factory,
                                                 const Predictor& predictor,
                                                 const HoldoutOptions& options = {});

}  // namespace wheeltap::emulator
