// The error of a frequency emulator, measured on FE runs outside its training set, and the error
// variance derived from it.
#pragma once

#include <span>
#include <vector>

#include "emulator/holdout.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::identification {

/// The emulator error for one number of damages.
struct EmulatorError {
  std::vector<emulator::HoldoutError> holdout;  ///< errors on the holdout runs, one per mode
  /// Scale factor of the error variance of each mode. For damages r_1 … r_k the error variance of
  /// mode i is scale[i] · Σ r_j / (1 - r_j), proportional to the compliance that the damages add.
  /// For an interpolant that predicts its own variance, the error variance is scale[i] times the
  /// predicted variance, with scale >= 1. The list is empty for table files of early Wheeltap
  /// versions, which have the constant variance rmse².
  std::vector<double> scale;
  /// Holdout residuals divided by the predicted standard deviation, one per mode
  std::vector<emulator::StandardisedResiduals> standardised;
  /// Leave-one-out RMSE, one per mode; empty if the interpolant does not compute it.
  std::vector<double> leave_one_out;
};

/// Computes the error variance [Hz²] of each mode under `damages`, for an interpolant that does not
/// predict its variance.
void error_variance(const EmulatorError& error, std::span<const fem::Damage> damages,
                    std::span<double> variance);

/// Computes holdout errors, scale and standardised residuals from true and predicted frequencies
/// [Hz] and unscaled variances [Hz²]. All matrices are FE runs × modes. `has_variance` is true if
/// the interpolant predicts the variances. A prediction of NaN is treated as exact, because the
/// likelihood then uses the FE solution.
[[nodiscard]] EmulatorError measured_error(const emulator::RowMatrix& truth,
                                           emulator::RowMatrix predicted,
                                           emulator::RowMatrix variance, bool has_variance);

/// Holdout errors, scale and standardised residuals in the format of table files: one row per mode.
[[nodiscard]] emulator::RowMatrix to_matrix(const EmulatorError& error);
/// The inverse of the function `to_matrix`.
[[nodiscard]] EmulatorError error_from(const emulator::RowMatrix& matrix);

}  // namespace wheeltap::identification
