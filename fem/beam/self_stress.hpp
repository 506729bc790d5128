// The stresses that a beam can carry without any load.
#pragma once

#include <Eigen/Core>

#include "base/eigen.hpp"
#include "fem/beam/beam.hpp"

namespace wheeltap::fem {

/// With the strains of the elements and of the springs as the rows of B, K = Bᵀ B; the
/// self-stresses are the null space of Bᵀ, as many as the supports are more than needed (none of a
/// cantilever or a simply supported beam). Orthonormal columns Q, so that
///
///   Q Qᵀ = I - B K⁻¹ Bᵀ = I - Σ_j c_j c_jᵀ / λ_j
///
/// over the elastic modes, c_j their strains: the sum written without its cancellation, which is
/// all that counts where a damage leaves next to nothing. Only the rows of the elements are
/// returned, 2 elements × (number of self-stresses), in the order of `FullSpectrum::strains`. From
/// equilibrium along the beam, in long double.
[[nodiscard]] Eigen::MatrixXd self_stresses(const Beam& beam);

}  // namespace wheeltap::fem
