// Computation of all modes of a discretised structure, for its reanalysis.
#pragma once

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// Every mode with mass: K φ = λ M φ, φᵀ M φ = 1.
struct StructureSpectrum {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Eigen::VectorXd eigenvalues;  ///< ascending; exactly 0 for rigid-body modes
  Matrix shapes;                ///< n × modes
  int rigid_body_modes = 0;
  Matrix massless = {};  ///< n × massless vectors ψ, M ψ = 0, ψᵀ K ψ = 1: static response
};

/// Computes all modes in O(n³) operations from M φ = μ (K + u M) φ; the largest μ belong to the
/// lowest modes. Up to `kWideSpectrum` degrees of freedom, the computation uses long double; above,
/// it uses double precision and refines the `refined` lowest modes like `structure_modes`. Massless
/// displacements are condensed exactly. Throws the exceptions of `structure_modes`.
inline constexpr int kWideSpectrum = 700;
[[nodiscard]] StructureSpectrum structure_spectrum(const Discretisation& d, int refined);

}  // namespace wheeltap::fem
