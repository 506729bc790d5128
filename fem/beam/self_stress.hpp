// Self-stress states of a beam: stresses that are in equilibrium without any load.
#pragma once

#include <Eigen/Core>

#include "base/eigen.hpp"
#include "fem/beam/beam.hpp"

namespace wheeltap::fem {

/// The rows of B are the strain-displacement vectors of elements and springs, so that K = Bᵀ B. The
/// self-stresses are the null space of Bᵀ. The number of self-stresses is the degree of static
/// indeterminacy (0 for a cantilever or a simply supported beam). The orthonormal columns Q satisfy
///
///   Q Qᵀ = I - B K⁻¹ Bᵀ = I - Σ_j c_j c_jᵀ / λ_j
///
/// summed over the elastic modes j with the strains c_j. This sum suffers from cancellation; the
/// computation of Q does not. An accurate Q is necessary if a damage leaves almost no stiffness.
/// This function returns only the rows of Q for the elements: two rows per element, in the order of
/// `FullSpectrum::strains`, and one column per self-stress. The self-stresses are computed from
/// equilibrium along the beam, in long double.
[[nodiscard]] Eigen::MatrixXd self_stresses(const Beam& beam);

}  // namespace wheeltap::fem
