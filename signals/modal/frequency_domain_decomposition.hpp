// Frequency domain decomposition: modes from the singular values of the response spectra.
//
// Under white forces, S(f) = mean of Y Yᴴ over segments has one large singular value s near a
// resonance, and its singular vector is the mode shape (fdd: Brincker, Zhang & Andersen 2001, Smart
// Mater. Struct. 10:441). Over the lines around a peak with nearly its shape (MAC above 0.8), s is
// the spectrum of one mode (efdd: Brincker, Ventura & Andersen 2001, IMAC 19). Its inverse
// transform over positive frequencies is c(τ) ∝ e^{λτ}. Least squares of ln c over the lags where
// |c| falls from 0.9 to 0.3 give λ, f = |λ| / 2π, ζ = -Re λ / |λ|. Segments are padded with zeros
// to twice their length, so that c is the correlation times that of the window and can be divided
// by it; otherwise the width of the window would count as damping.
//
// Assumes lightly damped, well separated modes. If two modes share lines, one is missed or
// both are distorted. Truncation of the bell biases damping.
#pragma once

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

struct DecompositionOptions {
  double sample_rate_hz = 1.0;
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< the band; 0: up to 0.45 of the rate
  int segment = 0;  ///< samples after decimation; 0: the power of 2 that gives at least 40 segments
  bool enhanced = true;  ///< true: efdd; false: fdd, without damping and standard deviations
  int blocks = 0;        ///< number of jackknife blocks; 0: 20
  int threads = 0;
};

/// `records` has one channel per row. Modes are peaks of the first singular value whose prominence
/// exceeds the scatter of this number of averages (three standard deviations either way, 3 dB at
/// least) and whose shape several lines share.
///
/// fdd: frequencies are lines, damping is NaN, `covariance` and shape covariances are empty. efdd:
/// covariances are a jackknife over blocks, (n_b - 1)/n_b Σ (x_k - x̄)(x_k - x̄)ᵀ with x_k of the
/// record without block k (Miller 1974, Biometrika 61:1); they include scatter but no bias. A peak
/// without a decay is dropped. Throws std::invalid_argument like identify_modes, and if the record
/// holds fewer than eight segments.
[[nodiscard]] ModalResult decompose_spectra(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                            const DecompositionOptions& options);

}  // namespace wheeltap::signals
