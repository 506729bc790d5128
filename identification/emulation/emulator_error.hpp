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
  std::vector<emulator::HoldoutError> holdout;  ///< one per mode
  /// Error variance of mode i at damages r_1 … r_k: scale[i] · Σ r_j / (1 - r_j), which grows with
  /// the damage as its effect does. For an interpolant with its own variance: scale[i] times that
  /// variance, scale >= 1. Empty in tables of early versions, whose variance is constant, rmse².
  std::vector<double> scale;
  std::vector<emulator::StandardisedResiduals> standardised;  ///< by that variance; one per mode
  /// Leave-one-out RMSE, one per mode; empty if the interpolant has none.
  std::vector<double> leave_one_out;
};

/// Computes each mode's error variance [Hz²] under `damages`, for an interpolant without its own.
void error_variance(const EmulatorError& error, std::span<const fem::Damage> damages,
                    std::span<double> variance);

/// Computes holdout errors, scale and standardised residuals from frequencies [Hz] and variances
/// [Hz²] at scale 1, runs × modes each. `has_variance`: the variances are the interpolant's own. A
/// mode predicted as NaN counts as exact, because the FE solution replaces it wherever it is used.
[[nodiscard]] EmulatorError measured_error(const emulator::RowMatrix& truth,
                                           emulator::RowMatrix predicted,
                                           emulator::RowMatrix variance, bool has_variance);

/// Holdout errors, scale and standardised residuals in the format of table files: one row per mode.
[[nodiscard]] emulator::RowMatrix to_matrix(const EmulatorError& error);
/// Inverse of `to_matrix`.
[[nodiscard]] EmulatorError error_from(const emulator::RowMatrix& matrix);

}  // namespace wheeltap::identification
