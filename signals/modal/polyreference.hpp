// Modes from frequency responses: the polyreference least-squares complex frequency-domain method.
//
//   H(ω) = B(Ω) A(Ω)⁻¹,  A(Ω) = Σ_{j=0}^{n} A_j Ω^j,  Ω = exp(-i (ω - ω₁) T),
//
// is a right matrix fraction with complex coefficients on the band [ω₁, ω₂]; T maps the band to
// nine tenths of the unit circle. The fit minimises the squares of B(Ω_k) - H(ω_k) A(Ω_k) with A_n
// = I, and eliminates B for each output separately (Guillaume et al. 2003, IMAC 21; Peeters, Van
// der Auweraer, Guillaume & Leuridan 2004, Shock Vib. 11:395). With A_n = I, the poles that fit
// only noise lie inside the unit circle of Ω. They are unstable, so their negative damping
// identifies them. Poles: det A(Ω_r) = 0, λ_r = iω₁ - ln Ω_r / T, with l_rᵀ A(Ω_r) = 0; shapes by
// fit_shapes.
//
// Noise biases the linear least-squares fit. The modes of the stabilisation diagram are therefore
// refined together by nonlinear least squares (modal_model.hpp).
//
// Uncertainty: the refined fit is repeated for H_fit + w e / √(1 - leverage) with its residuals
// e(ω) (wild bootstrap; Wu 1986, Ann. Stat. 14:1261, with the residuals of MacKinnon & White 1985).
// The complex normal w has unit variance and is common to all entries of a line, so errors that are
// common to outputs remain common. Residuals are too small at resonances with few lines; the
// leverage corrects for this.
#pragma once

#include <cstdint>

#include "signals/frequency_responses.hpp"
#include "signals/modal/modal_identification.hpp"
#include "signals/modal/modal_model.hpp"

namespace wheeltap::signals {

struct PolyreferenceOptions {
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< the band; 0: all lines
  int largest_order = 0;  ///< twice that of the polynomial; 0: 80, less for few lines
  int replicates = 50;    ///< number of bootstrap replicates
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Results for one polynomial order.
struct PolyreferenceFit {
  std::vector<Pole> poles = {};  ///< order 2n, by frequency; without standard deviations
  ModalModel model = {};         ///< in the same order
};

/// Stable poles (damping above 0, or slightly below) within the band of the lines. Throws
/// std::invalid_argument for n < 1, fewer than 2n + 2 lines, and a line at 0 Hz.
[[nodiscard]] PolyreferenceFit polyreference(const FrequencyResponses& responses, int n);

/// Selects modes from a stabilisation diagram of orders 2, 4, …, as identify_modes does for output
/// records. The bootstrap gives the covariance of all modes. Throws the exceptions of
/// polyreference, and std::invalid_argument for a band without lines, responses that are not finite
/// or all zero, and invalid coherence.
[[nodiscard]] ModalResult identify_modes(const FrequencyResponses& responses,
                                         const PolyreferenceOptions& options);

}  // namespace wheeltap::signals
