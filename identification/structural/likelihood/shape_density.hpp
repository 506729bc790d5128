// The density of a measured mode shape, given a computed mode shape.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::identification {

/// The density of a measured shape ψ with m entries. Scale and sign of ψ are arbitrary; only its
/// direction is measured. With noise e ~ N(0, Σ), ψ = a φ + e and unknown amplitude a (flat prior),
/// the density of the direction on the tangent plane at ψ̂ = ψ/|ψ| is
///
///   p(ψ | φ) = (2π)^{-(m-1)/2} |Σ|^{-1/2} (ψ̂ᵀ Σ⁻¹ ψ̂)^{-1/2} exp(-χ²/2),
///   χ² = min_a (ψ - a φ)ᵀ Σ⁻¹ (ψ - a φ),
///
/// to first order in the noise. The shape counts as m - 1 measured values, even if one entry is
/// scaled to exactly 1. For Σ = σ² I, p is the Watson density with concentration |ψ|²/(2σ²)
/// (Mardia & Jupp 2000, section 10.3.2). The residual after optimal scaling is that of Vanik, Beck
/// & Au (2000, section 3), who omit the normalising factor. At most one entry may have sd 0: the
/// entry by which the shape was divided.
///
/// If another mode k has nearly the frequency of the computed mode j, the model error may rotate
/// both in their common plane by an angle α ~ N(0, τ²) of period π (uniform for large τ). Then ψ =
/// a (cos α φ_j + sin α φ_k) + e, both mass-normalised, and exp(-χ²/2) becomes
///
///   exp(-χ²_plane/2) · √(2π) s · N_π(α̂; 0, τ² + s²),
///
/// with α̂ the best angle, s the sd of α̂ from the noise, and N_π the normal density wrapped at π.
/// This factor is the mean of exp(-χ²/2) over α, and at most 1. For τ = 0, this mean is exp(-χ²/2).
///
/// The model error may mix other modes into the computed mode: φ_j + Σ_k c_k φ_k with
/// c_k ~ N(0, τ_k²) (`Mixing`). The term a² Σ_k τ_k² φ_k φ_kᵀ is then added to Σ, where a is the
/// least-squares amplitude.
class ShapeDensity {
 public:
  /// `values` is ψ, of any scale and sign. `covariance` is Σ (m × m) for ψ scaled to a largest
  /// entry of 1. Without the row and column of an entry of zero variance, Σ must be positive
  /// definite. Throws std::invalid_argument for fewer than 2 entries, non-finite numbers, a zero
  /// shape, and an invalid covariance.
  ShapeDensity(Eigen::VectorXd values, const Eigen::MatrixXd& covariance);

  struct Comparison {
    double log_density = 0.0;
    double chi_square = 0.0;  ///< has `freedoms()` degrees of freedom; one fewer with a rotation
    double mac = 0.0;         ///< (ψ·φ)² / (|ψ|² |φ|²), for the measured entries
    double turn = 0.0;        ///< α̂ [rad]
  };
  /// Compares ψ with a computed shape φ at the measured entries. `scale` multiplies Σ (unknown
  /// noise); `more` (dimensionless) is added to the diagonal of Σ (model error).
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, double scale = 1.0,
                                   double more = 0.0) const;
  /// Compares ψ with a computed shape that may be rotated towards a close mode, for τ > 0.
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, const Eigen::VectorXd& close,
                                   double tau, double scale, double more) const;
  /// Other modes at the measured entries, one per column, and the sd of the mixing of each.
  struct Mixing {
    Eigen::MatrixXd others;
    Eigen::VectorXd tau;
  };
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, const Mixing& mixing, double scale,
                                   double more) const;
  /// Compares ψ with a computed shape; also gives the residual Σ^{-1/2} (ψ - a φ) and its
  /// sensitivity to changes of φ along each column of `moved`. The sensitivity is a · Σ^{-1/2} ·
  /// `moved`, projected orthogonally to Σ^{-1/2} φ, because the amplitude a adapts.
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, const Mixing& mixing, double scale,
                                   double more, const Eigen::MatrixXd& moved,
                                   Eigen::VectorXd& residual, Eigen::MatrixXd& moves) const;
  /// Returns ∂ log_density/∂φ of the comparison by `against` with the same arguments.
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& shape, double scale,
                                      double more) const;

  /// Log density of a uniformly distributed direction on the tangent plane at ψ: ln [Γ(m/2) /
  /// (π^{m/2} |ψ|^{m-1})].
  [[nodiscard]] double log_uniform_density() const;

  [[nodiscard]] int freedoms() const { return static_cast<int>(values_.size()) - 1; }
  [[nodiscard]] const Eigen::VectorXd& values() const { return values_; }
  /// Approximate sd of an entry of ψ.
  [[nodiscard]] double sd() const;

 private:
  /// Σ^{-1/2} in its principal axes, with `scale` and `more`.
  [[nodiscard]] Eigen::VectorXd weights(double scale, double more) const;
  [[nodiscard]] double log_normaliser(const Eigen::VectorXd& weights) const;
  /// `measured` and `computed` are premultiplied by Σ^{-1/2}.
  [[nodiscard]] Comparison fitted(const Eigen::VectorXd& shape, const Eigen::VectorXd& measured,
                                  const Eigen::VectorXd& computed, double log_normaliser) const;

  Eigen::VectorXd values_;   // ψ with the largest entry 1
  Eigen::MatrixXd axes_;     // eigenvectors of Σ as columns
  Eigen::VectorXd spread_;   // eigenvalues of Σ
  Eigen::VectorXd in_axes_;  // ψ in the principal axes of Σ
};

}  // namespace wheeltap::identification
