// Velocity and acceleration of a base displacement, by a cubic spline.
#pragma once

#include <span>
#include <vector>

namespace wheeltap::signals {

struct Spline {
  std::vector<double> first_derivative, second_derivative;  ///< at the samples
};

/// The natural cubic spline through equally spaced samples. Its second derivative is linear between
/// samples, and its values are the double integral of that. A base acceleration taken from it with
/// a first-order hold therefore moves the base exactly through the samples. For a signal of angle θ
/// = ω Δt per sample the second derivative is (4 sin²(θ/2)/θ²) · 3/(2 + cos θ) = 1 + θ²/12 + …
/// times -ω² y; the hold's sinc²(θ/2) = 1 - θ²/12 + … compensates it to second order. Throws
/// std::invalid_argument for fewer than 3 samples or spacing <= 0.
[[nodiscard]] Spline natural_spline(std::span<const double> samples, double spacing);

}  // namespace wheeltap::signals
