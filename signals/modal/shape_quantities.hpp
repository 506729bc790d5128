// Converts mode shapes of sensors with different quantities to one quantity.
//
// In a mode of eigenvalue λ = ω (-ζ + i √(1 - ζ²)) a displacement is φ exp(λt), its velocity λ φ
// exp(λt) and its acceleration λ² φ exp(λt). An entry of a lower order of differentiation is
// therefore multiplied by λ for each missing order (by iω if the damping is unknown).
#pragma once

#include <span>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// Converts the modes' shapes and their covariances to the highest order of `orders` (0:
/// displacement, 1: velocity, 2: acceleration; one per channel). Scales them to a largest entry of
/// 1, and updates collinearity, phase deviation and the doubt that follows from them. Neglects the
/// uncertainty of λ, which is small compared with that of shapes.
void convert_shapes(ModalResult& result, std::span<const int> orders);

}  // namespace wheeltap::signals
