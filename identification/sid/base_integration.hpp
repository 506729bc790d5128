// Computes the displacement of a moving base from its measured acceleration.
#pragma once

#include "identification/sid/sid_case.hpp"

namespace wheeltap::identification {

/// True if the case has a base acceleration, no base displacement, and a response that is an
/// absolute displacement or velocity.
[[nodiscard]] bool needs_integrated_base(const SidCase& sid_case);

/// Adds the base displacement as a channel: the double integral of the base acceleration plus a
/// polynomial for the constants of integration and the offset of the sensor. The integral is exact
/// if the acceleration is linear between samples. The polynomial is
///
///   y_base(t) = ∬ a + p₀ + p₁ t + p₂ t².
///
/// The coefficients are averages over the responses. For each response, the fitted polynomial
/// removes a quadratic trend, over the window, from the response relative to the base. Without a
/// displacement response, p₁ and p₂ follow from velocities and p₀ has no effect. The fit also
/// removes slow drift of the structure. SidCase::beyond is cleared, because the polynomial is not
/// valid after the window. Throws InvalidInput (channel) if a scale or offset of a used channel is
/// a parameter.
void integrate_base(SidCase& sid_case);

}  // namespace wheeltap::identification
