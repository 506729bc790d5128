// Natural frequencies and damping ratios of a chain's linear part.
#pragma once

#include <span>
#include <vector>

#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

/// An oscillation of the free chain, z = φ exp(λ t) with a pair of complex eigenvalues λ.
struct LinearMode {
  double frequency_hz;   ///< |λ| / 2π, the undamped one where damping is proportional
  double damping_ratio;  ///< -Re λ / |λ|; negative for a motion that grows
};

/// Modes of
///
///   M z̈ + C ż + K z = 0,
///
/// the chain without its laws beside stiffness and damping (springs beyond a gap and powers of the
/// extension vanish at rest; of friction and hysteresis it says nothing), in the order of their
/// frequency: complex pairs of eigenvalues of [0 1; -M⁻¹K -M⁻¹C]. A motion that does not oscillate
/// (rigid, overdamped, unstable at rest) is not among them. Masses must be > 0.
[[nodiscard]] std::vector<LinearMode> linear_modes(const Chain& chain,
                                                   std::span<const double> theta);

}  // namespace wheeltap::dynamics
