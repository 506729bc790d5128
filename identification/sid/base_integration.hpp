// A moving base of which only the acceleration was measured, where responses are absolute.
#pragma once

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// Whether the case has a base acceleration, no base displacement, and a response that is an
/// absolute displacement or velocity.
[[nodiscard]] bool needs_integrated_base(const SidCase& sid_case);

/// Adds the base's displacement, twice the integral of its acceleration (exact for one that is
/// linear between samples), as a channel of its own. What integration leaves open, and what a
/// sensor's offset makes of it, is a polynomial in time,
///
///   y_base(t) = ∬ a + p₀ + p₁ t + p₂ t²,
///
/// which is chosen so that the responses relative to the base have no such trend themselves, by
/// least squares over the window, the mean over the responses (p₁ and p₂ from velocities where no
/// displacement is among them; p₀ then moves nothing). A rig that drifts so slowly is taken for one
/// that does not. The window's continuation (SidCase::beyond) is given up: a polynomial tells
/// nothing beyond. Throws InvalidInput (channel) where a scale or offset of these channels is a
/// parameter.
void integrate_base(SidCase& sid_case);

}  // namespace wheeltap::identification
