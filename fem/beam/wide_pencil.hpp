// K φ = λ M φ in 106 bits: refines approximate modes and proves eigenvalue bounds.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/assembly.hpp"
#include "fem/beam/skyline_ldlt.hpp"
#include "fem/beam/strain_energy.hpp"

namespace wheeltap::fem {

/// The rigid motions that the supports leave free, mass-normalised, one per column. They are
/// computed exactly from the geometry, instead of as null vectors of a rounded K. Rows are all
/// degrees of freedom of the mesh.
[[nodiscard]] Eigen::Matrix<DoubleDouble, Eigen::Dynamic, Eigen::Dynamic> rigid_modes(
    const Beam& beam, const Defects& defects);

/// The banded matrices in double-double. Rounding moves an eigenvalue λ of the assembled matrices
/// by about 2⁻¹⁰⁴ λ_max, so λ keeps 15 digits up to λ_max / λ = 10¹⁶. Meshes of 150 elements reach
/// 10¹².
class WidePencil {
 public:
  using Real = DoubleDouble;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  WidePencil(const Beam& beam, const Defects& defects);

  [[nodiscard]] int size() const { return ldlt_.size(); }
  /// The rigid motions, in the free degrees of freedom.
  [[nodiscard]] const std::vector<Vector>& rigid_modes() const { return rigid_; }
  [[nodiscard]] const Assembly<Real>& assembly() const { return assembly_; }

  /// The number of eigenvalues below σ. Returns std::nullopt if the factorisation is unstable, for
  /// example because σ is nearly an eigenvalue of a leading block.
  [[nodiscard]] std::optional<int> count_below(Real sigma);

  /// True if eigenvalue `index` (from 0, ascending) lies in λ (1 ± error): at most `index`
  /// eigenvalues lie below λ (1 - error), and more than `index` below λ (1 + error).
  [[nodiscard]] bool holds(int index, Real lambda, double error);

  /// Rayleigh quotient iteration from q. On return q is mass-normalised and orthogonal to the rigid
  /// motions and to `others`. Returns the eigenvalue, or nothing if the iteration does not
  /// converge.
  [[nodiscard]] std::optional<Real> refine(Vector& q, const std::vector<Vector>& others = {});

  /// The share of rigid-body motions in q, in the norm of M, from 0 to 1.
  [[nodiscard]] double rigid_share(const Vector& q) const;

  /// u = T q on all degrees of freedom of the mesh.
  [[nodiscard]] Vector all_dofs(const Vector& q) const { return assembly_.free_to_all * q; }

 private:
  [[nodiscard]] Real normalise(Vector& q, const std::vector<Vector>& others) const;

  Assembly<Real> assembly_;
  SkylineLdlt<Real> ldlt_;
  StrainEnergy<Real> energy_;
  std::vector<Vector> rigid_, rigid_momentum_;  // φ and M φ in the free degrees of freedom
};

}  // namespace wheeltap::fem
