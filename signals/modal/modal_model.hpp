// Frequency responses as sums over modes, fitted to measured ones.
//
//   H(ω) = Σ_r (ψ_r l_rᵀ / (iω - λ_r) + ψ_r* l_rᴴ / (iω - λ_r*)) + L/ω² + U + V ω²,
//
// ψ_r the shape at the outputs, l_r the participation of the inputs, largest entry 1; L, U and V
// are what modes outside the band leave in it, of displacements over forces (L and U) as of
// accelerations (U and V), whose factors -ω² go into the residues. With λ and l given, the rest is
// linear least squares ("LSFD"; Heylen, Lammens & Sas 1997, section A.3). With them free, it is
// least squares over all lines, the maximum of the likelihood of noise that is equal at all of
// them: variable projection (Golub & Pereyra 1973) with Kaufman's (1975) Jacobian.
#pragma once

#include <complex>
#include <vector>

#include "signals/frequency_responses.hpp"

namespace wheeltap::signals {

struct ModalModel {
  std::vector<std::complex<double>> eigenvalues = {};  ///< λ_r [rad/s], Im λ > 0
  Eigen::MatrixXcd participation = {};                 ///< inputs × modes
  Eigen::MatrixXcd shapes = {};                        ///< outputs × modes
  std::vector<Eigen::MatrixXcd> fitted = {};           ///< at every line, outputs × inputs
  double squares = 0.0;  ///< Σ |H - fitted|² over all entries and lines
  /// Of refine: the share of each line's numbers that is fitted whatever they are (mean of the hat
  /// matrix' diagonal). A residual of variance σ² is left with σ² (1 - leverage).
  Eigen::VectorXd leverage = {};
};

/// Shapes and what is outside the band, for these poles. Throws std::invalid_argument for a line at
/// 0 Hz and factors that do not fit.
[[nodiscard]] ModalModel fit_shapes(const FrequencyResponses& responses,
                                    std::vector<std::complex<double>> eigenvalues,
                                    Eigen::MatrixXcd participation);

/// The least squares that are reached from these poles downhill; as fit_shapes where no step leads
/// down. Poles stay stable.
[[nodiscard]] ModalModel refine(const FrequencyResponses& responses, const ModalModel& start);

}  // namespace wheeltap::signals
