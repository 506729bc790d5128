// Residual flexibility of the omitted modes, and a few residual modes that represent this
// flexibility.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/reanalysis/static_condensation.hpp"

namespace wheeltap::fem {

/// For p kept modes and any linear forms C of the displacements, the residual flexibility is the
/// sum over the other modes (for a free structure, on the complement of its rigid motions),
///
///   Cᵀ (K - λ M)⁻¹ C - Σ_{j <= p} c_j c_jᵀ / (λ_j - λ) = R₀ + λ R₁ + λ² R₂ + λ³ R₃ + …,
///   R_n = Σ_{j > p} c_j c_jᵀ / λ_j^(n+1).
///
/// Linear forms are sums of *basic* forms: the strains and the degrees of freedom. With P = I - Φ
/// Φᵀ M, which removes the kept modes, and D = P K⁻¹ Pᵀ, R_n = aᵀ (D M)ⁿ D b. A basic form is
/// equivalent to displacements l_n of its part of the structure and forces r_n on the edge of this
/// part (`StaticCondensation`). Because D K = P,
///
///   (D M)ⁿ D a = P l_n + Σ_{i <= n} (D M)ⁱ D E r_{n-i}.
///
/// E selects the degrees of freedom of the boundary. With Q_n = Eᵀ (D M)ⁿ D E and α_n = Φᵀ M
/// l_n,
///
///   R_n = f_Iᵀ l_n' - Σ_{j <= p} λ_j α_0j α_nj' - r_0ᵀ Φ_E α_n'
///         + Σ_{i <= n} (Σ_{k <= i} Q_k r_{i-k} - Φ_E α_i)ᵀ r_{n-i}'.
///
/// The first term is zero unless both forms belong to the same part. A prime marks quantities of
/// the second form. Only Q_n requires solutions of the whole structure. The large contributions to
/// Q_n are subtracted in advance, so that no cancellation occurs. Q_n is computed for batches of
/// kBatch degrees of freedom. If the boundary is small, the constructor computes all batches;
/// for a large boundary, each batch is computed when it is first requested.
///
/// Any number of threads may share the object; results do not depend on the order of requests. The
/// cache holds at most `memory` bytes and removes the least recently used values.
class ResidualFlexibility {
 public:
  /// The moments R₀ … R₃ of two linear forms. The unit of R₀ is N⁻¹ times the units of the forms;
  /// each further moment has an additional factor s².
  struct Moments {
    double r[4] = {0.0, 0.0, 0.0, 0.0};
  };
  /// A linear form: basic forms with weights.
  using Form = std::vector<std::pair<int, double>>;

  /// `shapes` (n × p, mass-normalised) and `eigenvalues` of the lowest modes, rigid-body modes
  /// first. Throws InvalidStructure if the stiffness cannot be factored.
  ResidualFlexibility(std::shared_ptr<const Discretisation> d, const Eigen::MatrixXd& shapes,
                      const Eigen::VectorXd& eigenvalues, std::size_t memory);
  ~ResidualFlexibility();
  ResidualFlexibility(const ResidualFlexibility&) = delete;
  ResidualFlexibility& operator=(const ResidualFlexibility&) = delete;

  [[nodiscard]] static int strain(int row) { return row; }
  [[nodiscard]] int dof(int i) const;
  [[nodiscard]] Form motion(const SparseRow& row) const;

  [[nodiscard]] Moments moments(const Form& a, const Form& b) const;
  /// Computes row · u and row · w for the linear form a (`form`), where u = D a and w = D M u.
  [[nodiscard]] std::pair<double, double> responses(const SparseRow& row, const Form& form) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Residual modes: a few modes with the same moments R₀ … R₃ of m forms as the omitted modes. The
/// residual modes are the Ritz modes of the structure on span{u_a, w_a},
///
///   [R₀ R₁; R₁ R₂] y = θ [R₁ R₂; R₂ R₃] y.
///
/// The residual modes and the kept modes together represent a constrained structure. The
/// frequencies of the constrained structure are never below those of the whole structure, even
/// after the same changes of both. (The method is block Gauss quadrature of the sum over the other
/// modes; Golub & Meurant 2010, Matrices, Moments and Quadrature, chapters 4 and 6.)
struct ResidualModes {
  Eigen::VectorXd eigenvalues;  ///< θ, ascending
  Eigen::MatrixXd forms;        ///< m × modes: values of the forms in the mass-normalised modes
  Eigen::MatrixXd weights;      ///< 2m × modes: weights of u_1 … u_m, w_1 … w_m in each mode
};

/// Computes the residual modes. `moments[n]` is R_n, m × m. The matrix [R_0 R_1; R_1 R_2] is scaled
/// to a unit diagonal; its eigenvectors with eigenvalues of at most 1e-11 times the largest
/// eigenvalue are omitted.
[[nodiscard]] ResidualModes residual_modes(const Eigen::MatrixXd (&moments)[4]);

}  // namespace wheeltap::fem
