// All modes of the intact beam, to more than double precision.
#pragma once

#include "base/eigen.hpp"

#include "fem/beam/beam.hpp"

namespace wheeltap::fem {

/// Every mode of the mesh: K φ = λ M φ, φᵀ M φ = 1.
struct FullSpectrum {
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Vector eigenvalues;  ///< n, ascending [rad²/s²]; exactly 0 for rigid-body modes
  Matrix shapes;       ///< 2 (elements + 1) × n; held degrees of freedom included
  /// 2 elements × n: b·φ and a·φ of each element [√J], rounded once; 0 for rigid-body modes.
  Eigen::MatrixXd strains;
  int rigid_body_modes = 0;
};

/// By `lowest_modes`, O(n²) in all. Long double alone leaves an error of 2⁻⁶⁴ λ_max / λ_j in the
/// low modes' vectors, 1e-8 on soft springs, which the reanalysis would divide by what a damage
/// leaves of the stiffness. A beam that is held everywhere has no modes. Throws
/// std::invalid_argument for an invalid beam, std::runtime_error should an iteration not end.
[[nodiscard]] FullSpectrum full_spectrum(const Beam& beam);

}  // namespace wheeltap::fem
