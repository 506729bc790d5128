// K φ = ω² M φ of a discretised structure: natural frequencies and mode shapes.
#pragma once

#include <string>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// The lowest modes, rigid-body ones first.
struct StructureModes {
  Eigen::VectorXd frequencies_hz;  ///< ascending; exactly 0 for rigid-body modes
  Eigen::VectorXd eigenvalues;     ///< ω² [rad²/s²]
  /// n × modes: mass-normalised, φᵀ M φ = 1; the sign makes the largest motion positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  /// ‖K φ - λ M φ‖ in the norm of K⁻¹, over √λ: by Temple's bound λ is within its square times
  /// λ / gap of an eigenvalue, relative.
  Eigen::VectorXd residuals;
  /// None is missing: a Sturm count in a gap above the last mode found as many eigenvalues below as
  /// there are modes, or these are all that there are.
  bool certified = false;
  std::string solver;  ///< "spectra" or "dense", and why
};

/// How many modes there are: the rank of M in the free degrees of freedom. Massless ones follow the
/// others statically, which is exact.
[[nodiscard]] Eigen::Index mode_count(const Discretisation& d);

/// Shift-and-invert Lanczos (Spectra) or a dense solver finds approximate modes. A Rayleigh-Ritz
/// step on them and their residuals, both from the strains, takes out what the rounding of the
/// assembled and factored matrices (λ_max / λ times that of double) left in the low modes; and a
/// Sturm count by L D Lᵀ tells whether one is missing, a twin say, which is then looked for among
/// what is orthogonal to the rest.
///
/// Throws std::invalid_argument for more modes than there are; InvalidStructure for a mechanism (a
/// motion with mass that nothing resists, or a degree of freedom with neither stiffness nor mass),
/// naming it, and for axial forces beyond buckling.
[[nodiscard]] StructureModes structure_modes(const Discretisation& d, int modes);

/// Eigenvalues of K φ = λ M φ below σ, by the signs of D in K - σ M = L D Lᵀ (Sylvester).
/// Throws std::domain_error where σ is an eigenvalue.
[[nodiscard]] int eigenvalues_below(const Discretisation& d, double sigma);

}  // namespace wheeltap::fem
