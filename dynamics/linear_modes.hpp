// Natural frequencies and damping ratios of the linear part of a chain.
#pragma once

#include <span>
#include <vector>

#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

/// A free oscillation of the chain, z = φ exp(λ t), with a complex conjugate pair of eigenvalues λ.
struct LinearMode {
  double frequency_hz;   ///< |λ| / 2π; the undamped frequency for proportional damping
  double damping_ratio;  ///< -Re λ / |λ|; negative for a growing motion
};

/// Computes the modes of
///
///   M z̈ + C ż + K z = 0,
///
/// in order of frequency, from the complex pairs of eigenvalues of [0 1; -M⁻¹K -M⁻¹C]. Only the
/// linear stiffness and damping of the links are used. Contact springs with a gap and power laws of
/// the extension have no stiffness at rest. Friction and hysteresis are ignored. Modes without
/// oscillation (rigid-body, overdamped, unstable) are omitted. Masses must be > 0.
[[nodiscard]] std::vector<LinearMode> linear_modes(const Chain& chain,
                                                   std::span<const double> theta);

}  // namespace wheeltap::dynamics
