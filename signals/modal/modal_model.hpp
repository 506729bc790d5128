// Modal models of frequency response functions, fitted to measured frequency response functions.
//
//   H(ω) = Σ_r (ψ_r l_rᵀ / (iω - λ_r) + ψ_r* l_rᴴ / (iω - λ_r*)) + L/ω² + U + V ω²,
//
// where ψ_r is the mode shape at the outputs, and l_r is the participation vector of the inputs,
// with the largest entry 1. L, U and V represent modes outside the band: L and U for displacement
// responses, U and V for acceleration responses. The factors -ω² of accelerations are part of the
// residues. For fixed λ and l, the fit of the other parameters is a linear least-squares problem
// ("LSFD"; Heylen, Lammens & Sas 1997, section A.3). For free λ and l, the least-squares estimate
// over all spectral lines is the maximum-likelihood estimate for noise with equal variance at all
// lines. The method is variable projection (Golub & Pereyra 1973) with Kaufman's (1975) Jacobian.
#pragma once

#include <complex>
#include <vector>

#include "signals/frequency_responses.hpp"

namespace wheeltap::signals {

struct ModalModel {
  std::vector<std::complex<double>> eigenvalues = {};  ///< λ_r [rad/s], Im λ > 0
  Eigen::MatrixXcd participation = {};                 ///< inputs × modes
  Eigen::MatrixXcd shapes = {};                        ///< outputs × modes
  std::vector<Eigen::MatrixXcd> fitted = {};           ///< fitted responses at each spectral line,
                                                       ///< outputs × inputs
  double squares = 0.0;  ///< Σ |H - fitted|² over all entries and lines
  /// Leverage of each spectral line: the mean of the diagonal of the hat matrix. Only `refine` sets
  /// the leverage. For noise of variance σ², the residuals have the variance σ² (1 - leverage).
  Eigen::VectorXd leverage = {};
};

/// Fits mode shapes and residual terms for given poles. Throws std::invalid_argument for a spectral
/// line at 0 Hz and for participation factors of another size.
[[nodiscard]] ModalModel fit_shapes(const FrequencyResponses& responses,
                                    std::vector<std::complex<double>> eigenvalues,
                                    Eigen::MatrixXcd participation);

/// Refines the poles of the model `start` by minimising the sum of squares. If no iteration reduces
/// the sum of squares, the result is that of fit_shapes. The refined poles are stable.
[[nodiscard]] ModalModel refine(const FrequencyResponses& responses, const ModalModel& start);

}  // namespace wheeltap::signals
