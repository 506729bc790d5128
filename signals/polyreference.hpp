// Modes from frequency responses: the polyreference least-squares complex frequency-domain method.
//
//   H(ω) = B(Ω) A(Ω)⁻¹,  A(Ω) = Σ_{j=0}^{n} A_j Ω^j,  Ω = exp(-i (ω - ω₁) T),
//
// a right matrix fraction with complex coefficients on the band [ω₁, ω₂], which T maps to nine
// tenths of a turn. Least squares of B(Ω_k) - H(ω_k) A(Ω_k) with A_n = I; B is eliminated output by
// output (Guillaume et al. 2003, IMAC 21; Peeters, Van der Auweraer, Guillaume & Leuridan 2004,
// Shock Vib. 11:395). A_n = I puts the poles that only fit noise inside the unit circle of Ω, where
// they are no stable system's, so that damping tells them. Poles: det A(Ω_r) = 0,
// λ_r = iω₁ - ln Ω_r / T. Shapes by least squares with these poles (LSFD):
//
//   H(ω) = Σ_r (ψ_r l_rᵀ / (iω - λ_r) + ψ_r* l_rᴴ / (iω - λ_r*)) + L/ω² + U + V ω²,
//
// l_r the null vector of A(Ω_r); L, U and V are what modes outside the band leave in it, of
// displacements over forces (L and U) as of accelerations (U and V), whose factors -ω² go into the
// residues. Linear in ψ_r.
//
// Uncertainty: with the residuals e(ω) of that fit, the whole is repeated for H_fit + e · w, w
// complex normal of unit variance and one for all entries of a line (wild bootstrap; Wu 1986,
// Ann. Stat. 14:1261), so that errors that outputs share stay shared.
#pragma once

#include <cstdint>

#include "signals/frequency_responses.hpp"
#include "signals/modal_identification.hpp"

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
  std::vector<Pole> poles = {};             ///< order 2n, by frequency; no standard deviations
  Eigen::MatrixXcd participation = {};      ///< l_r by column: inputs × poles, largest entry 1
  std::vector<Eigen::MatrixXcd> fitted = {};  ///< at every line, outputs × inputs
  double parameters = 0.0;                  ///< of LSFD over its equations, for each output
};

/// Stable poles (0 < damping, or just below) within the lines' band. Throws std::invalid_argument
/// for n < 1, fewer than 2n + 2 lines, and a line at 0 Hz.
[[nodiscard]] PolyreferenceFit polyreference(const FrequencyResponses& responses, int n);

/// As identify_modes of output records: a stabilisation diagram of orders 2, 4, …, the modes it
/// holds, and the covariance of all of them by the bootstrap. Throws as above, and for a band
/// without lines, responses that are not finite or zero throughout, and coherence without use.
[[nodiscard]] ModalResult identify_modes(const FrequencyResponses& responses,
                                         const PolyreferenceOptions& options);

}  // namespace wheeltap::signals
