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
  Matrix massless = {};  ///< n × the motions without mass, M ψ = 0, ψᵀ K ψ = 1: they only yield
};

/// M φ = μ (K + u M) φ, whose largest μ are the lowest modes, in long double up to
/// `kWideSpectrum` degrees of freedom; beyond in double, and the `refined` lowest modes finished as
/// `structure_modes` does. Motions without mass are condensed by that, exactly. O(n³).
/// Throws as `structure_modes`.
inline constexpr int kWideSpectrum = 700;
[[nodiscard]] StructureSpectrum structure_spectrum(const Discretisation& d, int refined);

}  // namespace wheeltap::fem
