// Velocity and acceleration of a base displacement, computed by a cubic spline.
#pragma once

#include <span>
#include <vector>

namespace wheeltap::signals {

struct Spline {
  std::vector<double> first_derivative, second_derivative;  ///< derivatives at the samples
};

/// Computes the natural cubic spline through equally spaced samples. The second derivative of the
/// spline is linear between samples, and the spline is the double integral of its second
/// derivative. With this derivative as base acceleration (first-order hold), the base displacement
/// passes exactly through the samples. For a sine y with the phase angle θ = ω Δt per sample, the
/// second derivative is -ω² y times the factor (4 sin²(θ/2)/θ²) · 3/(2 + cos θ) = 1 + θ²/12 + …. To
/// second order, the factor sinc²(θ/2) = 1 - θ²/12 + … of the first-order hold compensates this
/// factor. Throws std::invalid_argument for fewer than 3 samples or spacing <= 0.
[[nodiscard]] Spline natural_spline(std::span<const double> samples, double spacing);

}  // namespace wheeltap::signals
