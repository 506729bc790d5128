// Shapes of sensors that measure unlike quantities, as shapes of one.
//
// In a mode of eigenvalue λ = ω (-ζ + i √(1 - ζ²)) a displacement is φ exp(λt), so that its
// velocity is λ φ exp(λt) and its acceleration λ² φ exp(λt): an entry of a sensor of lower order is
// multiplied by λ for each order between (by iω where the damping is not known).
#pragma once

#include <span>

#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {

/// Takes the modes' shapes to the highest order of `orders` (0: displacement, 1: velocity, 2:
/// acceleration; one a channel), with their covariances, scales them so that the largest entry is
/// 1, and renews what follows from a shape (collinearity, phase deviation and that doubt). The
/// uncertainty of λ itself, which is small beside that of shapes, is left out.
void convert_shapes(ModalResult& result, std::span<const int> orders);

}  // namespace wheeltap::signals
