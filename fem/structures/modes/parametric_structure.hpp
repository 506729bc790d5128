// A structure whose matrices depend on parameters. The stiffness matrix is a sum of constant terms
// with variable factors.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// A family of structures: one structure for each value of the d parameters θ.
struct StructureFamily {
  /// Returns the structure at θ. Throws InvalidStructure or std::invalid_argument if no valid
  /// structure exists at θ.
  std::function<Discretisation(std::span<const double>)> at;
  std::vector<double> nominal = {};  ///< θ₀
  /// For a structure that is given by matrices: K_rest = Σ scales_i(θ) parts_i, with scales > 0.
  std::vector<Discretisation::Sparse> parts = {};
  std::function<std::vector<double>(std::span<const double>)> scales = {};
};

/// The decomposition K(θ) = Σ_t q_t(θ) K_t, with q_t(θ₀) = 1, and M(θ). Strains form one term if
/// their directions do not depend on θ and their stiffnesses change by the same factor. If K is
/// given as matrices, each part of K is a term. A term may have any rank.
///
/// If all K_t are positive semidefinite, K(θ) ≽ α K(θ₀) with α = min q_t. Bounds of K(θ₀)⁻¹ then
/// give bounds of K(θ)⁻¹ (the "min-θ" of reduced bases; Rozza, Huynh & Patera 2008, section 4.2).
/// Low-rank terms K_t = C_t C_tᵀ, for example springs, may change by orders of magnitude without
/// weakening this bound. If α is the minimum over the other terms only,
///
///   K(θ) ≽ α (K(θ₀) + Σ (q_t/α - 1) C_t C_tᵀ).
class ParametricStructure {
 public:
  using Sparse = Discretisation::Sparse;

  enum class Form {
    affine,  ///< q and M are affine in θ; no assembly is necessary
    scaled,  ///< strains keep their directions; q and M come from assembly
    general  ///< structures that are neither affine nor scaled
  };

  /// Decomposes the matrices. `samples` holds values of θ, for example draws from the prior
  /// distribution. At the first 12 samples that give a valid structure, the constructor checks the
  /// decomposition to within 1e-10. Throws the exceptions of `family.at` at θ₀.
  ParametricStructure(StructureFamily family, std::span<const std::vector<double>> samples);

  /// The scale factors and matrices at one θ.
  struct Point {
    Eigen::VectorXd scales;                        ///< q_t; empty for `general`
    Eigen::VectorXd change;                        ///< θ - θ₀
    std::optional<Discretisation> assembled = {};  ///< empty for `affine`
    double floor = 0.0;                            ///< α; 0 if unknown
    /// q_t/α - 1 for each column of `low_rank()`, where t is the term of the column and α <= 1.
    Eigen::VectorXd excess = {};
  };
  /// Throws the exceptions of `family.at`.
  [[nodiscard]] Point at(std::span<const double> theta) const;
  /// Compute K(θ) u and M(θ) u for the columns u, with K u from the strains.
  [[nodiscard]] Eigen::MatrixXd stiffness_times(const Point& point, const Eigen::MatrixXd& u) const;
  [[nodiscard]] Eigen::MatrixXd mass_times(const Point& point, const Eigen::MatrixXd& u) const;
  /// Throws the exceptions of `family.at`.
  [[nodiscard]] Discretisation assemble(std::span<const double> theta) const {
    return family_.at(theta);
  }
  [[nodiscard]] Discretisation assemble(const Point& point) const;

  /// Computes Vᵀ K_t V of each term; the list is empty for `general`.
  [[nodiscard]] std::vector<Eigen::MatrixXd> project_terms(const Eigen::MatrixXd& basis) const;

  /// The matrix K_t of each term, n × n, both triangles; the list is empty for `general`.
  [[nodiscard]] std::vector<Sparse> term_matrices() const;
  /// The number of terms given as matrices (parts of K); these terms come last in the list.
  [[nodiscard]] std::size_t matrix_terms() const { return part_terms_.size(); }

  /// The matrices C_t of all low-rank terms, side by side. The number of columns of C_t is the rank
  /// of K_t. Empty if a term is not positive semidefinite.
  [[nodiscard]] const Eigen::MatrixXd& low_rank() const { return low_rank_; }
  [[nodiscard]] Form form() const { return form_; }
  /// The derivatives ∂q_t/∂θ_j (terms × d) and ∂M/∂θ_j; only for `affine`.
  [[nodiscard]] const Eigen::MatrixXd& scale_slopes() const { return slopes_; }
  [[nodiscard]] const std::vector<Sparse>& mass_slopes() const { return mass_slopes_; }
  [[nodiscard]] bool mass_changes() const { return mass_changes_; }
  /// The structure at θ₀.
  [[nodiscard]] const Discretisation& nominal() const { return nominal_; }
  [[nodiscard]] int parameters() const { return static_cast<int>(family_.nominal.size()); }
  [[nodiscard]] int terms() const { return terms_; }
  /// The index of the term that contains each strain of `nominal`. Empty for Form::general.
  [[nodiscard]] std::span<const int> term_of_strain() const {
    return form_ == Form::general ? std::span<const int>() : group_;
  }

 private:
  void group_strains(const std::vector<Discretisation>& at_samples);
  void take_parts();
  void find_low_rank();
  [[nodiscard]] std::optional<Eigen::VectorXd> scales_of(std::span<const double> theta,
                                                         const Discretisation& d) const;
  void try_affine(std::span<const std::vector<double>> samples,
                  const std::vector<Discretisation>& at_samples);
  [[nodiscard]] Eigen::VectorXd change_of(std::span<const double> theta) const;

  StructureFamily family_;
  Discretisation nominal_;
  Form form_ = Form::general;
  int terms_ = 0;
  std::vector<int> group_;          // index of the term of each strain
  std::vector<Sparse> part_terms_;  // the last terms: parts of K that is given as matrices
  std::vector<double> nominal_scales_;
  bool definite_ = false;  // true: every term is positive semidefinite
  Eigen::MatrixXd low_rank_;
  std::vector<int> term_of_column_;
  Eigen::MatrixXd slopes_;
  std::vector<Sparse> mass_slopes_;
  bool mass_changes_ = true;
};

}  // namespace wheeltap::fem
