// Modes from the singular values of the spectra of responses: frequency domain decomposition.
//
// Under forces that are white, S(f) = mean of Y Yᴴ over segments has one large singular value s
// near a resonance, and its vector is the shape there (fdd: Brincker, Zhang & Andersen 2001, Smart
// Mater. Struct. 10:441). Of the lines about a peak with nearly its shape (MAC above 0.8), s alone
// is a spectrum of one mode (efdd: Brincker, Ventura & Andersen 2001, IMAC 19): its inverse
// transform over positive frequencies is c(τ) ∝ e^{λτ}, ln c by least squares over the lags where
// |c| falls from 0.9 to 0.3 gives λ, f = |λ| / 2π, ζ = -Re λ / |λ|. Segments are padded with zeros
// to twice their length, so that c is the correlation times the window's own, which it is divided
// by: without that the window's width would be taken for damping.
//
// Assumes modes that are lightly damped and apart: of two that share lines, one is seen, or both
// are bent; the bell is cut, which biases damping.
#pragma once

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

struct DecompositionOptions {
  double sample_rate_hz = 1.0;
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< the band; 0: up to 0.45 of the rate
  int segment = 0;  ///< samples once decimated; 0: the power of 2 that leaves at least 40 segments
  bool enhanced = true;  ///< efdd; else fdd, without damping and scatter
  int blocks = 0;        ///< parts of the record that are left out in turn; 0: 20
  int threads = 0;
};

/// `records` holds a channel a row. Modes are peaks of the first singular value that stand out of
/// what is between them and higher ones by more than averages of this number scatter (three
/// standard deviations either way, 3 dB at least), with a shape that some lines share.
///
/// fdd: frequencies are lines, damping is NaN, `covariance` and shape covariances are empty. efdd:
/// covariances are a jackknife over blocks, (n_b - 1)/n_b Σ (x_k - x̄)(x_k - x̄)ᵀ with x_k of the
/// record without block k (Miller 1974, Biometrika 61:1): scatter, and no bias. A peak that gives
/// no decay is left out. Throws std::invalid_argument as identify_modes does, and for segments that
/// the record does not hold eight of.
[[nodiscard]] ModalResult decompose_spectra(const Eigen::Ref<const Eigen::MatrixXd>& records,
                                            const DecompositionOptions& options);

}  // namespace wheeltap::signals
