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
  /// n × modes: mass-normalised, φᵀ M φ = 1; the largest motion is positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  /// ‖K φ - λ M φ‖ in the norm of K⁻¹, divided by √λ. By Temple's bound, the relative distance of λ
  /// to an eigenvalue is at most λ / gap times the square of the scaled residual.
  Eigen::VectorXd residuals;
  /// True if no mode is missing: a Sturm count in a gap above the last mode found confirms the
  /// number of modes, or these are all modes of the structure.
  bool certified = false;
  std::string solver;  ///< "spectra" or "dense", with the reason
};

/// The number of modes: the rank of M in the free degrees of freedom. Massless degrees of freedom
/// follow exactly from the others by statics.
[[nodiscard]] Eigen::Index mode_count(const Discretisation& d);

/// Shift-and-invert Lanczos (Spectra) or a dense solver finds approximate modes. Rounding of the
/// assembled and factored matrices (λ_max / λ times that of double) leaves errors in the low modes.
/// A Rayleigh-Ritz step on the modes and their residuals, both computed from the strains, removes
/// these errors. A Sturm count by L D Lᵀ detects a missing mode, for example one of two close
/// modes; the search then continues among vectors orthogonal to the modes found.
///
/// Throws std::invalid_argument for more modes than there are. Throws InvalidStructure for axial
/// forces beyond buckling and for a mechanism, which it names: a motion with mass but without
/// stiffness, or a degree of freedom with neither stiffness nor mass.
[[nodiscard]] StructureModes structure_modes(const Discretisation& d, int modes);

/// The number of eigenvalues of K φ = λ M φ below σ, from the signs of D in K - σ M = L D Lᵀ
/// (Sylvester). Throws std::domain_error if σ is an eigenvalue.
[[nodiscard]] int eigenvalues_below(const Discretisation& d, double sigma);

}  // namespace wheeltap::fem
