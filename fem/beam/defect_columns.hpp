// Damages and added supports as columns of the secular problem. Internal to the reanalysis.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "fem/beam/defect.hpp"
#include "fem/beam/intact_modes.hpp"
#include "fem/secular.hpp"

namespace wheeltap::fem::detail {

/// A damaged element changes K by -Γ c cᵀ on its two strains, Γ = 1 - Π (1 - r), a support by
/// + k c cᵀ on its motion; Γ = -k there. With every Γ in one diagonal, damaged eigenvalues solve
///
///   det [Γ⁻¹ - Cᵀ (K - λ M)⁻¹ C] = 0.
///
/// At the static part, G = Γ⁻¹ - Σ_j c_j c_jᵀ / s_j, this matrix is scaled away: supports first,
/// G = L J Lᵀ with J = diag(-1, 1), L = [L_s 0; W Rᵀ],
///
///   L_s L_sᵀ = 1/k + Σ_j c_j c_jᵀ / s_j (supports),   W = Σ_j c_j (L_s⁻¹ c_j)ᵀ / s_j,
///   Rᵀ R = q / (1 - q) + Q Qᵀ + W Wᵀ (damages),   q = Π (1 - r),
///
/// Q the self-stresses (`self_stresses`), and R gains Σ_j c_j c_jᵀ (1/λ_j - 1/s_j) of soft modes,
/// whose s_j > λ_j where supports are added. Every term of R is a square and R is built by
/// rotations, row by row, so that it keeps its digits however little is left of the elements.
/// `Secular` sees the columns L⁻¹ C.
class DefectColumns {
 public:
  /// Throws std::invalid_argument for defects outside the beam or out of range.
  void set(const IntactModes& intact, const SecularKernel& kernel, std::span<const Damage> damages,
           std::span<const SpringSupport> supports);

  [[nodiscard]] int count() const { return support_columns_ + damage_columns_; }
  [[nodiscard]] int supports() const { return support_columns_; }
  /// How many of those supports are rigid: each takes a degree of freedom.
  [[nodiscard]] int held() const { return held_; }
  /// Rigid-body modes that the defects leave.
  [[nodiscard]] int rigid_body_modes() const { return rigid_; }
  /// The least of q: λ_i damaged >= q λ_i intact.
  [[nodiscard]] double least_remaining() const { return least_remaining_; }
  /// Σ k Σ_j c_j² of the springs: bounds what they raise any eigenvalue by.
  [[nodiscard]] double added_stiffness() const { return added_stiffness_; }
  /// The greatest k Σ_j c_j² / s_j of the springs: stiffness over the beam's own at their place.
  [[nodiscard]] double stiffest_spring() const { return stiffest_spring_; }
  /// L⁻¹ C, a column after the other.
  [[nodiscard]] const double* columns() const { return columns_.data(); }

  /// One damaged element.
  struct Element {
    int element;
    double remaining;  ///< q = Π (1 - r)
    double lost;       ///< 1 - q, which q near 1 would not say
  };
  [[nodiscard]] std::span<const Element> elements() const { return elements_; }
  /// Column of a listed support; -1 of one that holds what is held already.
  [[nodiscard]] std::span<const int> support_column() const { return support_column_; }

  /// The motion or strain cᵀφ of each column, from the forces η of L⁻¹ C: Γ⁻¹ L⁻ᵀ η, in place.
  void strains(std::span<double> eta) const;

 private:
  void merge(const IntactModes& intact, std::span<const Damage> damages);
  double* add_column(const IntactModes& intact, double inverse_gamma);
  bool add_support(const IntactModes& intact, const SecularKernel& kernel, const SpringSupport& s,
                   bool rigid_ones);
  void add_damages(const IntactModes& intact, const SecularKernel& kernel);
  void rotate_in(double* row);

  std::vector<Element> elements_;  // ascending; the order of the damages must not matter
  std::vector<int> support_column_;
  std::vector<double> columns_;        // count × stride
  std::vector<double> inverse_gamma_;  // 1/lost, -1/k, or 0 of a rigid support
  std::vector<double> factor_;         // L, row-major, most_ a row
  std::vector<double> springs_;        // of each support column: its part besides L_s⁻¹ c
  std::vector<double> row_;            // scratch
  std::size_t most_ = 0;               // columns there could be
  int support_columns_ = 0, damage_columns_ = 0, held_ = 0, rigid_ = 0;
  double least_remaining_ = 1.0, added_stiffness_ = 0.0, stiffest_spring_ = 0.0;
};

}  // namespace wheeltap::fem::detail
