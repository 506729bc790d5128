// Modal models of frequency responses, fitted to measured ones.
//
//   H(ω) = Σ_r (ψ_r l_rᵀ / (iω - λ_r) + ψ_r* l_rᴴ / (iω - λ_r*)) + L/ω² + U + V ω²,
//
// ψ_r is the mode shape at the outputs and l_r the participation vector of the inputs, with the
// largest entry 1. L, U and V represent modes outside the band: L and U for responses in
// displacement, U and V for responses in acceleration. The factors -ω² of accelerations are part of
// the residues. For fixed λ and l, the rest is linear least squares ("LSFD"; Heylen, Lammens & Sas
// 1997, section A.3). For free λ and l, least squares over all lines are the maximum of the
// likelihood of noise with equal variance at all lines: variable projection (Golub & Pereyra 1973)
// with Kaufman's (1975) Jacobian.
#pragma once

#include <complex>
#include <vector>

#include "signals/frequency_responses.hpp"

namespace wheeltap::signals {

struct ModalModel {
  std::vector<std::complex<double>> eigenvalues = {};  ///< λ_r [rad/s], Im λ > 0
  Eigen::MatrixXcd participation = {};                 ///< inputs × modes
  Eigen::MatrixXcd shapes = {};                        ///< outputs × modes
  std::vector<Eigen::MatrixXcd> fitted = {};           ///< per line, outputs × inputs
  double squares = 0.0;  ///< Σ |H - fitted|² over all entries and lines
  /// Set by `refine`: the leverage of each line, that is the mean of the diagonal of the hat
  /// matrix. A residual of variance σ² is reduced to σ² (1 - leverage).
  Eigen::VectorXd leverage = {};
};

/// Fits shapes and residual terms for given poles. Throws std::invalid_argument for a line at 0 Hz
/// and for participation factors of another size.
[[nodiscard]] ModalModel fit_shapes(const FrequencyResponses& responses,
                                    std::vector<std::complex<double>> eigenvalues,
                                    Eigen::MatrixXcd participation);

/// Refines the poles by minimising the sum of squares from this start. If no step reduces the sum,
/// the result is that of fit_shapes. Poles remain stable.
[[nodiscard]] ModalModel refine(const FrequencyResponses& responses, const ModalModel& start);

}  // namespace wheeltap::signals
