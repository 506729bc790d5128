// What the modes of a structure that are not kept yield to, and the few modes that stand for them.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/reanalysis/static_condensation.hpp"

namespace wheeltap::fem {

/// With p modes kept, C any linear forms of the motion, and sums over the others (of a free
/// structure, on the complement of its rigid motions),
///
///   Cᵀ (K - λ M)⁻¹ C - Σ_{j <= p} c_j c_jᵀ / (λ_j - λ) = R₀ + λ R₁ + λ² R₂ + λ³ R₃ + …,
///   R_n = Σ_{j > p} c_j c_jᵀ / λ_j^(n+1).
///
/// Forms are sums of *basic* ones, the strains and the degrees of freedom. With P = I - Φ Φᵀ M
/// taking out the kept modes and D = P K⁻¹ Pᵀ, R_n = aᵀ (D M)ⁿ D b. A basic form is met by motions
/// l_n of its part and forces r_n on that part's edge (`StaticCondensation`), and D K = P, so that
///
///   (D M)ⁿ D a = P l_n + Σ_{i <= n} (D M)ⁱ D E r_{n-i},
///
/// E the boundary's dofs. With Q_n = Eᵀ (D M)ⁿ D E and α_n = Φᵀ M l_n,
///
///   R_n = f_Iᵀ l_n' - Σ_{j <= p} λ_j α_0j α_nj' - r_0ᵀ Φ_E α_n'
///         + Σ_{i <= n} (Σ_{k <= i} Q_k r_{i-k} - Φ_E α_i)ᵀ r_{n-i}',
///
/// the first term where both are on one part; primes are the second form's. Only Q_n needs
/// solutions of the whole structure, and what is large in it has been taken out before, so that
/// nothing cancels. Q_n is computed for kBatch degrees of freedom at a time: all of them at once
/// where they are few, else when they are asked for.
///
/// Any number of threads may ask; answers do not depend on the order of questions. What was
/// computed is forgotten, the longest unasked first, beyond `memory` bytes.
class ResidualFlexibility {
 public:
  /// R₀ … R₃ of two forms [N⁻¹ of what they measure, s² more each].
  struct Moments {
    double r[4] = {0.0, 0.0, 0.0, 0.0};
  };
  /// A linear form: weights of basic ones.
  using Form = std::vector<std::pair<int, double>>;

  /// `shapes` (n × p, mass-normalised) and `eigenvalues` of the lowest modes, rigid-body ones
  /// first. Throws InvalidStructure where the stiffness cannot be factored.
  ResidualFlexibility(std::shared_ptr<const Discretisation> d, const Eigen::MatrixXd& shapes,
                      const Eigen::VectorXd& eigenvalues, std::size_t memory);
  ~ResidualFlexibility();
  ResidualFlexibility(const ResidualFlexibility&) = delete;
  ResidualFlexibility& operator=(const ResidualFlexibility&) = delete;

  [[nodiscard]] static int strain(int row) { return row; }
  [[nodiscard]] int dof(int i) const;
  [[nodiscard]] Form motion(const SparseRow& row) const;

  [[nodiscard]] Moments moments(const Form& a, const Form& b) const;
  /// row · u and row · w of a form, u = D a and w = D M u.
  [[nodiscard]] std::pair<double, double> responses(const SparseRow& row, const Form& form) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Few modes with the R₀ … R₃ of m forms: the Ritz modes of the structure on span{u_a, w_a},
///
///   [R₀ R₁; R₁ R₂] y = θ [R₁ R₂; R₂ R₃] y.
///
/// Beside the kept modes they make a constrained structure: its frequencies, changed along these
/// forms or not, are not below those of the whole. (Block Gauss quadrature of the sum over the
/// other modes; Golub & Meurant 2010, Matrices, Moments and Quadrature, chapters 4 and 6.)
struct ResidualModes {
  Eigen::VectorXd eigenvalues;  ///< θ, ascending
  Eigen::MatrixXd forms;        ///< m × modes: the forms of the mass-normalised modes
  Eigen::MatrixXd weights;      ///< 2m × modes: of u_1 … u_m, w_1 … w_m in each
};

/// `moments[n]`: R_n, m × m. What is 1e-11 of the forms' own flexibility is left out.
[[nodiscard]] ResidualModes residual_modes(const Eigen::MatrixXd (&moments)[4]);

}  // namespace wheeltap::fem
