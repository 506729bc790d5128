// Computation of the strain energy φᵀ K φ without cancellation.
#pragma once

#include "fem/beam/assembly.hpp"

namespace wheeltap::fem {

/// Computes φᵀ K φ = Σ_e (1 - r_e) [(b·φ_e)² + (a·φ_e)²] + Σ k (N(x)·φ)². For smooth shapes on fine
/// meshes, the product with the assembled matrix K suffers from cancellation; the sum of squared
/// strains does not. Rayleigh quotients of the low modes therefore keep full relative accuracy.
template <class Real>
class StrainEnergy {
 public:
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  StrainEnergy(const Beam& beam, const Defects& defects)
      : element_(beam), remaining_(remaining_stiffness<Real>(beam, defects)) {
    const auto add = [&](double at, bool rotation, double stiffness) {
      if (std::isfinite(stiffness))
        springs_.push_back({motion_row(beam, element_, at, rotation), stiffness});
    };
    for (const Support& s : beam.supports)
      if (s.stiffness) {
        if (s.deflection) add(s.at, false, *s.stiffness);
        if (s.rotation) add(s.at, true, *s.stiffness);
      }
    for (const SpringSupport& s : defects.supports) add(s.location, s.rotation, s.stiffness);
  }

  /// Returns twice the strain energy [J] of the shape u (all degrees of freedom of the mesh).
  [[nodiscard]] Real twice(const Eigen::Ref<const Vector>& u) const {
    const auto bending = element_.bending(), shear = element_.shear();
    Real sum = 0;
    for (Eigen::Index e = 0; e < remaining_.size(); ++e) {
      const Real b = bending.dot(u.template segment<4>(2 * e));
      const Real a = shear.dot(u.template segment<4>(2 * e));
      sum += remaining_[e] * (b * b + a * a);
    }
    for (const auto& [row, stiffness] : springs_) {
      const Real motion = row.coefficients.dot(u.template segment<4>(row.first_dof));
      sum += Real{stiffness} * motion * motion;
    }
    return sum;
  }

 private:
  TimoshenkoElement<Real> element_;
  Vector remaining_;  // Π (1 - r) of each element
  std::vector<std::pair<MotionRow<Real>, double>> springs_;
};

}  // namespace wheeltap::fem
