// Natural frequencies and mode shapes of a discretised structure, from K φ = ω² M φ.
#pragma once

#include <string>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// The lowest modes of a structure, rigid-body modes first.
struct StructureModes {
  Eigen::VectorXd frequencies_hz;  ///< ascending; exactly 0 for rigid-body modes
  Eigen::VectorXd eigenvalues;     ///< ω² [rad²/s²]
  /// Mode shapes, n × modes. Shapes are mass-normalised, φᵀ M φ = 1, and the largest entry is
  /// positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  /// Scaled residuals: ‖K φ - λ M φ‖ in the norm of K⁻¹, divided by √λ. By Temple's bound, the
  /// relative distance of λ to an eigenvalue is at most λ / gap times the square of the scaled
  /// residual, where gap is the distance to the next eigenvalue.
  Eigen::VectorXd residuals;
  /// True if no mode is missing. Either a Sturm count in a gap above the highest computed mode
  /// confirms the number of modes, or the result contains all modes of the structure.
  bool certified = false;
  std::string solver;  ///< "spectra" or "dense", with the reason for the choice
};

/// Returns the number of modes of the structure: the rank of M in the free degrees of freedom. The
/// displacements of massless degrees of freedom follow statically and exactly from those of the
/// other degrees of freedom.
[[nodiscard]] Eigen::Index mode_count(const Discretisation& d);

/// Computes the lowest modes. Shift-and-invert Lanczos (Spectra) or a dense solver finds
/// approximate modes. Rounding of the assembled and factored matrices causes relative errors in the
/// low modes of about λ_max / λ times the unit round-off of double precision. A Rayleigh-Ritz step
/// on the modes and their residuals, both computed from the strains, removes these errors. A Sturm
/// count by L D Lᵀ detects a missing mode, for example one of two closely spaced modes; the search
/// then continues in the space orthogonal to the computed modes.
///
/// Throws std::invalid_argument if `modes` exceeds the number of modes of the structure. Throws
/// InvalidStructure if axial forces exceed the buckling load, and for a mechanism; the message
/// describes the mechanism. A mechanism is a motion with mass but without stiffness, or a degree of
/// freedom with neither stiffness nor mass.
[[nodiscard]] StructureModes structure_modes(const Discretisation& d, int modes);

/// Returns the number of eigenvalues of K φ = λ M φ below σ, from the signs of D in K - σ M = L D
/// Lᵀ (Sylvester's law of inertia). Throws std::domain_error if σ is an eigenvalue.
[[nodiscard]] int eigenvalues_below(const Discretisation& d, double sigma);

}  // namespace wheeltap::fem
