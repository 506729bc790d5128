// All modes of the intact beam, to more than double precision.
#pragma once

#include "base/eigen.hpp"

#include "fem/beam.hpp"

namespace wheeltap::fem {

/// Every mode of the mesh: K φ = λ M φ, φᵀ M φ = 1.
struct FullSpectrum {
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Vector eigenvalues;  ///< n, ascending [rad²/s²]; exactly 0 for rigid-body modes
  Matrix shapes;       ///< 2 (elements + 1) × n; held degrees of freedom included
  int rigid_body_modes = 0;
};

/// Sturm counts isolate each eigenvalue and Rayleigh quotient iteration finishes it, on the banded
/// matrices in long double: O(n²) in all, and the low modes keep the relative accuracy that a dense
/// eigensolve of K and M loses to cond(K) (Parlett 1998, The Symmetric Eigenvalue Problem, ch. 3,
/// 4). The quotient is a sum of squared element strains, so it does not cancel. Throws
/// std::invalid_argument for an invalid beam, std::runtime_error should an iteration not end.
[[nodiscard]] FullSpectrum full_spectrum(const Beam& beam);

}  // namespace wheeltap::fem
