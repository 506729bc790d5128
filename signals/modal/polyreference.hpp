// Modes from frequency responses: the polyreference least-squares complex frequency-domain method.
//
//   H(ω) = B(Ω) A(Ω)⁻¹,  A(Ω) = Σ_{j=0}^{n} A_j Ω^j,  Ω = exp(-i (ω - ω₁) T),
//
// a right matrix fraction with complex coefficients on the band [ω₁, ω₂], which T maps to nine
// tenths of a turn. Least squares of B(Ω_k) - H(ω_k) A(Ω_k) with A_n = I; B is eliminated output by
// output (Guillaume et al. 2003, IMAC 21; Peeters, Van der Auweraer, Guillaume & Leuridan 2004,
// Shock Vib. 11:395). A_n = I puts the poles that only fit noise inside the unit circle of Ω, where
// they are no stable system's, so that damping tells them. Poles: det A(Ω_r) = 0,
// λ_r = iω₁ - ln Ω_r / T, with l_rᵀ A(Ω_r) = 0; shapes by fit_shapes.
//
// Linear least squares are biased by noise: the modes that the diagram holds are then refined
// together (modal_model.hpp).
//
// Uncertainty: with the residuals e(ω) of the refined fit, it is repeated for
// H_fit + w e / √(1 - leverage), w complex normal of unit variance and one for all entries of a
// line (wild bootstrap; Wu 1986, Ann. Stat. 14:1261, with the residuals of MacKinnon & White 1985),
// so that errors that outputs share stay shared, and a resonance that few lines see is not fitted
// too well to be believed.
#pragma once

#include <cstdint>

#include "signals/frequency_responses.hpp"
#include "signals/modal/modal_identification.hpp"
#include "signals/modal/modal_model.hpp"

namespace wheeltap::signals {

struct PolyreferenceOptions {
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< the band; 0: all lines
  int largest_order = 0;  ///< twice the polynomial's; 0: 80, less where there are few lines
  int replicates = 50;    ///< of the bootstrap
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Of one polynomial order.
struct PolyreferenceFit {
  std::vector<Pole> poles = {};  ///< order 2n, by frequency; no standard deviations
  ModalModel model = {};         ///< in their order
};

/// Stable poles (damping above 0, or just below) within the lines' band. Throws
/// std::invalid_argument for n < 1, fewer than 2n + 2 lines, and a line at 0 Hz.
[[nodiscard]] PolyreferenceFit polyreference(const FrequencyResponses& responses, int n);

/// As identify_modes of output records: a stabilisation diagram of orders 2, 4, …, the modes it
/// holds, and the covariance of all of them by the bootstrap. Throws as above, and for a band
/// without lines, responses that are not finite or zero throughout, and coherence without use.
[[nodiscard]] ModalResult identify_modes(const FrequencyResponses& responses,
                                         const PolyreferenceOptions& options);

}  // namespace wheeltap::signals
