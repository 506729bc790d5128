// Modes from frequency response functions: the polyreference least-squares complex frequency-domain
// method.
//
//   H(ω) = B(Ω) A(Ω)⁻¹,  A(Ω) = Σ_{j=0}^{n} A_j Ω^j,  Ω = exp(-i (ω - ω₁) T),
//
// is a right matrix fraction with complex coefficients on the band [ω₁, ω₂]. The factor T maps the
// band to nine tenths of the unit circle. The fit minimises the sum of squares of B(Ω_k) - H(ω_k)
// A(Ω_k) with A_n = I, and eliminates B for each output separately (Guillaume et al. 2003, IMAC 21;
// Peeters, Van der Auweraer, Guillaume & Leuridan 2004, Shock Vib. 11:395). With A_n = I, the poles
// that fit only noise lie inside the unit circle of Ω. These poles are unstable and therefore have
// negative damping ratios. The poles λ_r = iω₁ - ln Ω_r / T follow from det A(Ω_r) = 0, and the
// participation vectors from l_rᵀ A(Ω_r) = 0. fit_shapes computes the mode shapes.
//
// Noise biases the linear least-squares fit. The modes of the stabilisation diagram are therefore
// refined together by nonlinear least squares (modal_model.hpp).
//
// Uncertainty: the refined fit has the frequency response functions H_fit and the residuals e(ω).
// The fit is repeated for the data H_fit + w e / √(1 - leverage) (wild bootstrap; Wu 1986, Ann.
// Stat. 14:1261, with the residuals of MacKinnon & White 1985). The complex normal random number w
// has unit variance and is the same for all entries of a spectral line. Errors that are common to
// several outputs therefore remain common. At resonances with few spectral lines, the residuals are
// smaller than the noise. The factor 1 / √(1 - leverage) corrects for this difference.
#pragma once

#include <cstdint>

#include "signals/frequency_responses.hpp"
#include "signals/modal/modal_identification.hpp"
#include "signals/modal/modal_model.hpp"

namespace wheeltap::signals {

struct PolyreferenceOptions {
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< frequency band; 0: all spectral lines
  int largest_order = 0;  ///< twice the polynomial order; 0: 80, or less for few spectral lines
  int replicates = 50;    ///< number of bootstrap replicates
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Results for one polynomial order n.
struct PolyreferenceFit {
  std::vector<Pole> poles = {};  ///< poles of order 2n, by frequency, without standard deviations
  ModalModel model = {};         ///< modal model with the modes in the same order
};

/// Computes the poles for the polynomial order n. The result contains only poles within the
/// frequency band of the spectral lines. Their damping ratios are positive or slightly negative.
/// Throws std::invalid_argument for n < 1, fewer than 2n + 2 lines, and a spectral line at 0 Hz.
[[nodiscard]] PolyreferenceFit polyreference(const FrequencyResponses& responses, int n);

/// Identifies modes from frequency response functions. Like identify_modes for output records, this
/// function selects the modes from a stabilisation diagram of model orders 2, 4, …. The bootstrap
/// gives the covariance of all modes. Throws the exceptions of polyreference, and
/// std::invalid_argument for a band without spectral lines, frequency response functions that are
/// not finite or all zero, and invalid coherence.
[[nodiscard]] ModalResult identify_modes(const FrequencyResponses& responses,
                                         const PolyreferenceOptions& options);

}  // namespace wheeltap::signals
