// All modes of a discretised structure, for its reanalysis.
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
  Matrix massless = {};  ///< n × massless motions, M ψ = 0, ψᵀ K ψ = 1: static response only
};

/// Solves M φ = μ (K + u M) φ, whose largest μ are the lowest modes, in O(n³). Uses long double up
/// to `kWideSpectrum` degrees of freedom. Beyond, it uses double and refines the `refined` lowest
/// modes like `structure_modes`. Massless motions are condensed exactly. Throws the exceptions of
/// `structure_modes`.
inline constexpr int kWideSpectrum = 700;
[[nodiscard]] StructureSpectrum structure_spectrum(const Discretisation& d, int refined);

}  // namespace wheeltap::fem
