// The eigenvalue problem K φ = λ M φ in 106-bit (double-double) arithmetic: refinement of
// approximate modes and verified eigenvalue bounds.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/assembly.hpp"
#include "fem/beam/skyline_ldlt.hpp"
#include "fem/beam/strain_energy.hpp"

namespace wheeltap::fem {

/// Computes the rigid-body modes that the supports allow, mass-normalised, one per column.
/// The modes are computed exactly from the geometry, and not as the null space of the rounded
/// matrix K. Each row is a degree of freedom of the mesh.
[[nodiscard]] Eigen::Matrix<DoubleDouble, Eigen::Dynamic, Eigen::Dynamic> rigid_modes(
    const Beam& beam, const Defects& defects);

/// The banded matrices K and M in double-double numbers. Rounding of the assembled matrices changes
/// an eigenvalue λ by about 2⁻¹⁰⁴ λ_max. At least 15 digits of λ are therefore correct up to λ_max
/// / λ = 10¹⁶. On meshes of 150 elements, this ratio is 10¹².
class WidePencil {
 public:
  using Real = DoubleDouble;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  WidePencil(const Beam& beam, const Defects& defects);

  [[nodiscard]] int size() const { return ldlt_.size(); }
  /// Returns the rigid-body modes in the free degrees of freedom.
  [[nodiscard]] const std::vector<Vector>& rigid_modes() const { return rigid_; }
  [[nodiscard]] const Assembly<Real>& assembly() const { return assembly_; }

  /// Returns the number of eigenvalues below σ. Returns std::nullopt if the factorisation is
  /// unstable, for example because σ is nearly an eigenvalue of a leading principal submatrix.
  [[nodiscard]] std::optional<int> count_below(Real sigma);

  /// True if eigenvalue `index` (from 0, ascending) lies in λ (1 ± error): at most `index`
  /// eigenvalues lie below λ (1 - error), and more than `index` below λ (1 + error).
  [[nodiscard]] bool holds(int index, Real lambda, double error);

  /// Refines the approximate mode q by Rayleigh quotient iteration. On return, q is mass-normalised
  /// and orthogonal to the rigid-body modes and to `others`. Returns the eigenvalue, or
  /// std::nullopt if the iteration does not converge.
  [[nodiscard]] std::optional<Real> refine(Vector& q, const std::vector<Vector>& others = {});

  /// Returns the rigid-body fraction of the displacement q, from 0 to 1, in the norm of M.
  [[nodiscard]] double rigid_share(const Vector& q) const;

  /// Returns u = T q, the displacements of all degrees of freedom of the mesh.
  [[nodiscard]] Vector all_dofs(const Vector& q) const { return assembly_.free_to_all * q; }

 private:
  [[nodiscard]] Real normalise(Vector& q, const std::vector<Vector>& others) const;

  Assembly<Real> assembly_;
  SkylineLdlt<Real> ldlt_;
  StrainEnergy<Real> energy_;
  std::vector<Vector> rigid_, rigid_momentum_;  // φ and M φ in the free degrees of freedom
};

}  // namespace wheeltap::fem
