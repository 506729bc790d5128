// Frequency domain decomposition: modes from the singular values of the response spectra.
//
// Under white forces, S(f) = mean of Y Yᴴ over segments has one large singular value s near a
// resonance, and its singular vector is the mode shape (fdd: Brincker, Zhang & Andersen 2001, Smart
// Mater. Struct. 10:441). Over the lines around a peak with nearly its shape (MAC above 0.8), s is
// the spectrum of one mode (efdd: Brincker, Ventura & Andersen 2001, IMAC 19). Its inverse
// transform over positive frequencies is c(τ) ∝ e^{λτ}. Least squares of ln c over the lags where
// |c| falls from 0.9 to 0.3 give λ, f = |λ| / 2π, ζ = -Re λ / |λ|. Segments are padded with zeros
// to twice their length. Then c is the product of the correlations of the response and of the
// window, and is divided by the latter. Without this correction, the spectral width of the window
// would increase the damping.
//
// Assumes lightly damped, well separated modes. If two modes share lines, the method misses one of
// them or distorts both. The truncation of the spectral bell biases damping ratios.
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

/// `records` has one channel per row. Modes are peaks of the first singular value that satisfy two
/// conditions. The prominence exceeds the scatter of a spectrum with this number of averages (three
/// standard deviations up and down, at least 3 dB). Several lines have the shape of the peak.
///
/// With fdd, frequencies are those of lines, damping ratios are NaN, and the covariances are empty.
/// With efdd, covariances are those of the jackknife over blocks, (n_b - 1)/n_b Σ (x_k - x̄)(x_k -
/// x̄)ᵀ, where x_k is the result without block k (Miller 1974, Biometrika 61:1). They include
/// scatter but no bias. efdd omits a peak whose correlation does not decay. Throws
/// std::invalid_argument like identify_modes, and if the record holds fewer than eight segments.
[[nodiscard]] ModalResult decompose_spectra(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                            const DecompositionOptions& options);

}  // namespace wheeltap::signals
