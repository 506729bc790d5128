// The density of a measured mode shape, given a computed one.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::identification {

/// A measured shape ψ of m entries has no scale and no sign: what was measured is a line. With
/// entries' noise e ~ N(0, Σ), ψ = a φ + e, and the amplitude a unknown (flat), the density of the
/// line on the tangent plane at ψ̂ = ψ/|ψ| is
///
///   p(ψ | φ) = (2π)^{-(m-1)/2} |Σ|^{-1/2} (ψ̂ᵀ Σ⁻¹ ψ̂)^{-1/2} exp(-χ²/2),
///   χ² = min_a (ψ - a φ)ᵀ Σ⁻¹ (ψ - a φ),
///
/// to first order in the noise: m - 1 numbers were measured, not m, and a scale that made one entry
/// exactly 1 adds none. For Σ = σ² I it is Watson's density with concentration |ψ|²/(2σ²) (Mardia &
/// Jupp 2000, section 10.3.2); the residual after optimal scaling is that of Vanik, Beck & Au
/// (2000, section 3), which lacks the normaliser. An entry whose sd is 0 is the one that the others
/// were divided by; one may be.
///
/// Where another mode k is close to the computed one, j, what the model leaves out may have turned
/// both in their common plane, by an angle α ~ N(0, τ²) of period π: uniform for large τ. Then
/// ψ = a (cos α φ_j + sin α φ_k) + e, both mass-normalised, and the factor exp(-χ²/2) becomes
///
///   exp(-χ²_plane/2) · √(2π) s · N_π(α̂; 0, τ² + s²),
///
/// α̂ being the best angle, s its sd from the noise and N_π the normal wrapped at π: the mean over α
/// of how well each angle fits, and so 1 at most. τ = 0 is the above.
///
/// Where the model's error mixes other modes into the computed one, φ_j + Σ_k c_k φ_k with
/// c_k ~ N(0, τ_k²) (`Mixing`), Σ gains a² Σ_k τ_k² φ_k φ_kᵀ, a the amplitude by least squares.
class ShapeDensity {
 public:
  /// `values`: ψ, of any scale and sign; `covariance`: Σ of ψ scaled to a largest entry of 1, m × m
  /// and positive definite but for one entry. Throws std::invalid_argument for fewer than 2
  /// entries, numbers that are not finite, a zero shape, and a covariance that is none.
  ShapeDensity(Eigen::VectorXd values, const Eigen::MatrixXd& covariance);

  struct Comparison {
    double log_density = 0.0;
    double chi_square = 0.0;  ///< of `freedoms()`, less one where there was a turn
    double mac = 0.0;         ///< (ψ·φ)² / (|ψ|² |φ|²), of the entries measured
    double turn = 0.0;        ///< α̂ [rad]
  };
  /// `shape`: φ at the entries measured. `scale` multiplies Σ and `more` [1] is added to its
  /// diagonal: an unknown scatter, and what the model leaves out.
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, double scale = 1.0,
                                   double more = 0.0) const;
  /// With a close mode, and τ > 0.
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, const Eigen::VectorXd& close,
                                   double tau, double scale, double more) const;
  /// Other modes at the entries measured, a column each, and how far they may be mixed in.
  struct Mixing {
    Eigen::MatrixXd others;
    Eigen::VectorXd tau;
  };
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, const Mixing& mixing, double scale,
                                   double more) const;
  /// The same, with the residual Σ^{-1/2} (ψ - a φ) and how it moves when φ does by each column of
  /// `moved`, less what a follows: a Σ^{-1/2} moved, across Σ^{-1/2} φ.
  [[nodiscard]] Comparison against(const Eigen::VectorXd& shape, const Mixing& mixing, double scale,
                                   double more, const Eigen::MatrixXd& moved,
                                   Eigen::VectorXd& residual, Eigen::MatrixXd& moves) const;
  /// ∂ log_density/∂φ of the first.
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& shape, double scale,
                                      double more) const;

  /// Of a line that may point anywhere, Γ(m/2) / π^{m/2}, on the same tangent plane at ψ.
  [[nodiscard]] double log_uniform_density() const;

  [[nodiscard]] int freedoms() const { return static_cast<int>(values_.size()) - 1; }
  [[nodiscard]] const Eigen::VectorXd& values() const { return values_; }
  /// Standard deviation of an entry, about.
  [[nodiscard]] double sd() const;

 private:
  /// Σ^{-1/2} in its own axes, with scale and addition.
  [[nodiscard]] Eigen::VectorXd weights(double scale, double more) const;
  [[nodiscard]] double log_normaliser(const Eigen::VectorXd& weights) const;
  /// `measured`, `computed`: times Σ^{-1/2}.
  [[nodiscard]] Comparison fitted(const Eigen::VectorXd& shape, const Eigen::VectorXd& measured,
                                  const Eigen::VectorXd& computed, double log_normaliser) const;

  Eigen::VectorXd values_;   // largest entry 1
  Eigen::MatrixXd axes_;     // of Σ, columns
  Eigen::VectorXd spread_;   // its eigenvalues
  Eigen::VectorXd in_axes_;  // ψ
};

}  // namespace wheeltap::identification
