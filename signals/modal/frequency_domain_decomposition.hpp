// Frequency domain decomposition: modes from the singular values of the response spectra. Under
// white forces, the spectral matrix S(f), the mean of Y Yᴴ over segments, has one large singular
// value s near a resonance. The singular vector of s is the mode shape (fdd: Brincker, Zhang &
// Andersen 2001, Smart Mater. Struct. 10:441). Near a peak, the spectral lines whose singular
// vector has a MAC above 0.8 with that of the peak belong to the mode. Over these lines, s is the
// spectrum of one mode (efdd: Brincker, Ventura & Andersen 2001, IMAC 19). The inverse Fourier
// transform of s over positive frequencies is c(τ) ∝ e^{λτ}. A least-squares fit of ln c over the
// lags where |c| falls from 0.9 to 0.3 gives λ, f = |λ| / 2π, ζ = -Re λ / |λ|. Segments are padded
// with zeros to twice their length. Then c is the product of the correlation function of the
// response and the correlation function of the window. The method divides c by the correlation
// function of the window. Without this correction, the spectral width of the window would increase
// the estimated damping ratio. The method assumes lightly damped, well separated modes. If two
// modes occupy the same spectral lines, the method misses one mode or distorts both estimates. The
// damping ratio is biased, because a mode's spectrum is truncated to the spectral lines with its
// singular vector.
#pragma once

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

struct DecompositionOptions {
  double sample_rate_hz = 1.0;
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< band; highest_hz = 0: 0.45 of the sampling rate
  int segment = 0;  ///< segment length in samples after decimation; 0: the power of 2 that gives at
                    ///< least 40 segments
  bool enhanced = true;  ///< true: efdd; false: fdd, without damping and standard deviations
  int blocks = 0;        ///< number of data blocks of the jackknife; 0: 20
  int threads = 0;
};

/// `records` has one channel per row. Modes are peaks of the first singular value that satisfy two
/// conditions. First, the prominence of the peak is at least 3 dB and at least 10 log₁₀((1 + ε) /
/// (1 - ε)) dB, where ε = 3/√n (at most 0.9) is three relative standard deviations of a spectrum
/// with n averages. Second, the singular vectors at several lines nearly equal that of the peak.
///
/// With fdd, natural frequencies are the frequencies of spectral lines, damping ratios are NaN, and
/// the covariances are empty. With efdd, covariances are estimated by the jackknife over blocks,
/// (n_b - 1)/n_b Σ (x_k - x̄)(x_k - x̄)ᵀ, where x_k is the result without block k (Miller 1974,
/// Biometrika 61:1). The jackknife covariances include the random errors of the estimates but not
/// their bias. efdd omits a peak whose correlation function c does not decay. Throws
/// std::invalid_argument in the same cases as identify_modes, and if the record holds fewer than
/// eight segments.
[[nodiscard]] ModalResult decompose_spectra(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                            const DecompositionOptions& options);

}  // namespace wheeltap::signals
