// How wrong an emulator of frequencies is, measured on FE runs that it has not seen, and the
// variance that it therefore claims for an answer.
#pragma once

#include <span>
#include <vector>

#include "emulator/holdout.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::identification {

/// For one number of damages.
struct EmulatorError {
  std::vector<emulator::HoldoutError> holdout;  ///< one a mode
  /// The variance of mode i's error at damages r_1 … r_k is scale[i] · Σ r_j / (1 - r_j): it grows
  /// with the damage, as the effect itself does. For an interpolant with a variance of its own it
  /// is scale[i] times that, scale >= 1. Empty in tables of early versions: a constant rmse².
  std::vector<double> scale;
  std::vector<emulator::StandardisedResiduals> standardised;  ///< by that variance, one a mode
  /// Leave-one-out RMSE, one a mode, where the interpolant has it; else empty.
  std::vector<double> leave_one_out;
};

/// The variance [Hz²] of each mode's error under `damages`, for an interpolant without its own.
void error_variance(const EmulatorError& error, std::span<const fem::Damage> damages,
                    std::span<double> variance);

/// Holdout errors, scale and standardised residuals, from frequencies [Hz] and variances [Hz²] at
/// scale 1, runs × modes each; `has_variance` says whether these are the interpolant's own. A mode
/// predicted as NaN counts as exact there: the FE solution takes its place wherever it is used.
[[nodiscard]] EmulatorError measured_error(const emulator::RowMatrix& truth,
                                           emulator::RowMatrix predicted,
                                           emulator::RowMatrix variance, bool has_variance);

/// Holdout errors, scale and standardised residuals as table files keep them: a row a mode.
[[nodiscard]] emulator::RowMatrix to_matrix(const EmulatorError& error);
/// Its inverse.
[[nodiscard]] EmulatorError error_from(const emulator::RowMatrix& matrix);

}  // namespace wheeltap::identification
