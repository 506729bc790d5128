// The two-node Timoshenko beam element with consistent mass and rotary inertia.
#pragma once

#include "base/eigen.hpp"

#include "fem/beam/beam.hpp"
#include "fem/double_double.hpp"

namespace wheeltap::fem {

/// Flexural properties of an element of length l: EI, κGA (∞: no shear deformation), ρA and ρI.
template <class Real>
struct Flexure {
  Real length;             ///< l [m]
  Real bending_stiffness;  ///< E I [N·m²]
  Real shear_stiffness;    ///< κ G A [N]
  Real mass;               ///< ρ A [kg/m]
  Real rotary;             ///< ρ I [kg·m]
};

/// A two-node beam element of length l. Inside the element, the deflection w and the rotation θ
/// follow from the homogeneous static equilibrium of a Timoshenko beam. The shape functions
/// therefore contain Φ = 12 E I / (κ G A l²), and the element does not lock (Friedman & Kosmatka
/// 1993, Computers & Structures 47:473). The degrees of freedom are (w₁, θ₁, w₂, θ₂); for Φ = 0, θ
/// = w'.
///
/// `Real` is double, or a type of higher precision for the low modes of fine meshes.
template <class Real>
class TimoshenkoElement {
 public:
  using Vector = Eigen::Matrix<Real, 4, 1>;
  using Matrix = Eigen::Matrix<Real, 4, 4>;

  explicit TimoshenkoElement(const Beam& beam);
  explicit TimoshenkoElement(const Flexure<Real>& flexure);

  /// Stiffness matrix K = b bᵀ + a aᵀ [N/m, N, N·m]. The rank of K is 2, because rigid-body motions
  /// are stress-free.
  [[nodiscard]] Matrix stiffness() const {
    return bending() * bending().transpose() + shear() * shear().transpose();
  }
  /// Strain-displacement vector of a constant curvature: b = √(EI/l) (0, -1, 0, 1).
  [[nodiscard]] Vector bending() const;
  /// Strain-displacement vector of a constant shear: a = √(12 EI / (l³ (1 + Φ))) (1, l/2, -1, l/2).
  [[nodiscard]] Vector shear() const;
  /// Mass matrix M = ρA ∫ N_wᵀ N_w dx + ρI ∫ N_θᵀ N_θ dx [kg, kg·m, kg·m²].
  [[nodiscard]] Matrix mass() const;

  /// Shape functions N_w(ξ) and N_θ(ξ), 0 <= ξ = x/l <= 1: w = N_w · u, θ = N_θ · u.
  [[nodiscard]] Vector deflection_row(Real xi) const;
  [[nodiscard]] Vector rotation_row(Real xi) const;
  /// Derivative of the deflection, w'(ξ) = N_w'(ξ) · u [1/m, 1]. The row N_w' differs from N_θ if
  /// the beam deforms in shear.
  [[nodiscard]] Vector slope_row(Real xi) const;

  [[nodiscard]] Real length() const { return l_; }

 private:
  Real l_;        // element length [m]
  Real bending_;  // E I [N·m²]
  Real phi_;      // Φ [-]
  Real mass_;     // ρ A [kg/m]
  Real rotary_;   // ρ I [kg·m]
};

extern template class TimoshenkoElement<double>;
extern template class TimoshenkoElement<long double>;
extern template class TimoshenkoElement<DoubleDouble>;

}  // namespace wheeltap::fem
