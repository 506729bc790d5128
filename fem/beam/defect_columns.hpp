// Representation of stiffness reductions and added supports as columns of the secular problem.
// Internal to the reanalysis.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "fem/beam/defect.hpp"
#include "fem/beam/intact_modes.hpp"
#include "fem/secular.hpp"

namespace wheeltap::fem::detail {

/// A damaged element changes K by -Γ c cᵀ for each of its two strain-displacement vectors c, where
/// Γ is 1 - Π (1 - r). A support changes K by + k c cᵀ, that is Γ = -k, where c is the row of the
/// restrained deflection or rotation. With all c as columns of C and all Γ in a diagonal matrix,
/// the eigenvalues of the damaged beam solve
///
///   det [Γ⁻¹ - Cᵀ (K - λ M)⁻¹ C] = 0.
///
/// This matrix is scaled by its static part G = Γ⁻¹ - Σ_j c_j c_jᵀ / s_j (s_j:
/// `IntactModes::scales`). With the supports listed first, G = L J Lᵀ, J = diag(-1, 1), L = [L_s 0;
/// W Rᵀ],
///
///   L_s L_sᵀ = 1/k + Σ_j c_j c_jᵀ / s_j (supports),   W = Σ_j c_j (L_s⁻¹ c_j)ᵀ / s_j,
///   Rᵀ R = q / (1 - q) + Q Qᵀ + W Wᵀ (damages),   q = Π (1 - r),
///
/// where Q are the self-stresses (`self_stresses`). With added supports, s_j > λ_j for soft modes,
/// which only deform the springs. The sum Σ_j c_j c_jᵀ (1/λ_j - 1/s_j) over the soft modes is added
/// to Rᵀ R. Every term of Rᵀ R is a square, and Givens rotations assemble R row by row. R is
/// therefore accurate even if almost no stiffness remains. `Secular` receives the columns L⁻¹ C.
class DefectColumns {
 public:
  /// Computes the columns of these defects. Throws std::invalid_argument for defects outside the
  /// beam or with values out of range.
  void set(const IntactModes& intact, const SecularKernel& kernel, std::span<const Damage> damages,
           std::span<const SpringSupport> supports);

  [[nodiscard]] int count() const { return support_columns_ + damage_columns_; }
  [[nodiscard]] int supports() const { return support_columns_; }
  /// Number of degrees of freedom that rigid supports eliminate: one per rigid support.
  [[nodiscard]] int held() const { return held_; }
  /// Number of rigid-body modes of the damaged beam.
  [[nodiscard]] int rigid_body_modes() const { return rigid_; }
  /// The smallest remaining fraction q of an element's stiffness. Eigenvalue i of the damaged beam
  /// is at least q times eigenvalue i of the intact beam.
  [[nodiscard]] double least_remaining() const { return least_remaining_; }
  /// Σ k Σ_j c_j² over the springs: an upper bound on the increase of any eigenvalue.
  [[nodiscard]] double added_stiffness() const { return added_stiffness_; }
  /// The largest value of k Σ_j c_j² / s_j over the springs. This value is the ratio of the spring
  /// stiffness to the stiffness of the beam at the same location.
  [[nodiscard]] double stiffest_spring() const { return stiffest_spring_; }
  /// The matrix L⁻¹ C, column by column.
  [[nodiscard]] const double* columns() const { return columns_.data(); }

  /// One damaged element.
  struct Element {
    int element;
    double remaining;  ///< q = Π (1 - r)
    double lost;       ///< 1 - q, stored separately because the subtraction loses digits if q is
                       ///< near 1
  };
  [[nodiscard]] std::span<const Element> elements() const { return elements_; }
  /// Index of the column of each listed support; -1 if the displacement at this support is
  /// already restrained.
  [[nodiscard]] std::span<const int> support_column() const { return support_column_; }

  /// Computes cᵀφ, the displacement or strain of each column c, from the forces η in the columns
  /// L⁻¹ C. Replaces η by the result Γ⁻¹ L⁻ᵀ η.
  void strains(std::span<double> eta) const;

 private:
  void merge(const IntactModes& intact, std::span<const Damage> damages);
  double* add_column(const IntactModes& intact, double inverse_gamma);
  bool add_support(const IntactModes& intact, const SecularKernel& kernel, const SpringSupport& s,
                   bool rigid_ones);
  void add_damages(const IntactModes& intact, const SecularKernel& kernel);
  void rotate_in(double* row);

  std::vector<Element>
      elements_;  // elements in ascending order, so that the order of reductions has no effect
  std::vector<int> support_column_;
  std::vector<double> columns_;        // count × stride
  std::vector<double> inverse_gamma_;  // 1/lost, -1/k, or 0 for a rigid support
  std::vector<double> factor_;         // L, row-major, most_ entries per row
  std::vector<double> springs_;        // spring components of each support column, from 1/√k
  std::vector<double> row_;            // scratch
  std::size_t most_ = 0;               // largest possible number of columns
  int support_columns_ = 0, damage_columns_ = 0, held_ = 0, rigid_ = 0;
  double least_remaining_ = 1.0, added_stiffness_ = 0.0, stiffest_spring_ = 0.0;
};

}  // namespace wheeltap::fem::detail
