// Computation of all modes of the intact beam with more than double precision.
#pragma once

#include "base/eigen.hpp"

#include "fem/beam/beam.hpp"

namespace wheeltap::fem {

/// All modes of the finite-element model: K φ = λ M φ, φᵀ M φ = 1.
struct FullSpectrum {
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Vector eigenvalues;  ///< n, ascending [rad²/s²]; exactly 0 for rigid-body modes
  Matrix shapes;       ///< 2 (elements + 1) × n; includes restrained degrees of freedom
  /// 2 elements × n: the strains b·φ and a·φ of each element [√J], rounded to double only at the
  /// end; 0 for rigid-body modes.
  Eigen::MatrixXd strains;
  int rigid_body_modes = 0;
};

/// Computes all modes by `lowest_modes` in O(n²) operations. With long double alone, the
/// eigenvectors of the low modes would have an error of 2⁻⁶⁴ λ_max / λ_j, for example 1e-8 for a
/// beam on soft springs. The reanalysis amplifies the errors of the modes by the reciprocal of the
/// remaining fraction of the stiffness. A fully restrained beam has no modes. Throws
/// std::invalid_argument for an invalid beam, and std::runtime_error if an iteration does not
/// converge.
[[nodiscard]] FullSpectrum full_spectrum(const Beam& beam);

}  // namespace wheeltap::fem
