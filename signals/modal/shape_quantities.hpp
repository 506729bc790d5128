// Conversion of mode shapes from sensors of different quantities to one quantity.
//
// In a mode with the eigenvalue λ = ω (-ζ + i √(1 - ζ²)), the displacement is φ exp(λt), the
// velocity λ φ exp(λt) and the acceleration λ² φ exp(λt). Conversion to a higher time derivative
// therefore multiplies the entry of a channel by λ for each derivative. If the damping ratio is
// unknown, iω replaces λ.
#pragma once

#include <span>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// Converts the modes' shapes and their covariances to the highest order of `orders` (0:
/// displacement, 1: velocity, 2: acceleration; one per channel). Scales each shape to a largest
/// entry of 1. Updates the collinearity, the phase deviation and the reason for doubt
/// ModeDoubt::complex_shape. Neglects the uncertainty of λ, which is small compared with the
/// uncertainty of shapes.
void convert_shapes(ModalResult& result, std::span<const int> orders);

}  // namespace wheeltap::signals
