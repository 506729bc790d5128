// The matrices of K φ = ω² M φ, and the strains from which they are assembled.
#pragma once

#include <Eigen/SparseCore>

#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// A linear form of the degrees of freedom: Σ coefficients[i] u[dofs[i]]. Dofs ascend.
struct SparseRow {
  std::vector<int> dofs = {};
  std::vector<double> coefficients = {};

  [[nodiscard]] double of(const Eigen::Ref<const Eigen::VectorXd>& u) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < dofs.size(); ++i) sum += coefficients[i] * u[dofs[i]];
    return sum;
  }
  [[nodiscard]] bool empty() const { return dofs.empty(); }
};

/// factor (row · u)²: twice the energy of one strain; factor 1, or -1 of a compressed member's
/// geometric stiffness. The row holds the square root of the stiffness.
struct Strain {
  SparseRow row;
  double factor = 1.0;
};

/// The name of a degree of freedom, for messages and sensors.
struct DofName {
  std::string place;  ///< a node, or a place on a member
  std::string direction;
};

/// K φ = λ M φ in the n free degrees of freedom. K = Bᵀ D B + K_rest from the strains B. φᵀ K φ is
/// then a sum of squares without cancellation. With the assembled matrix, smooth shapes on fine
/// meshes suffer from cancellation.
struct Discretisation {
  using Sparse = Eigen::SparseMatrix<double>;

  std::vector<DofName> names;      ///< n
  std::vector<Strain> strains;     ///< the rows of B
  Sparse rest;                     ///< K_rest, n × n: the part given as a matrix (or empty)
  std::vector<Sparse> parts = {};  ///< summands of `rest`; empty if they are not distinguished
  Sparse stiffness;                ///< K, n × n, both triangles
  Sparse mass;                     ///< M, n × n, positive semidefinite
  Eigen::MatrixXd rigid_motions;   ///< n × r: strain-free motions, in any basis

  [[nodiscard]] Eigen::Index size() const { return mass.rows(); }
  /// Selects r of the n degrees of freedom (r rigid motions) whose restraint prevents all rigid
  /// motions.
  [[nodiscard]] std::vector<char> holding_dofs() const;
  /// K u, computed from the strains.
  [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::Ref<const Eigen::VectorXd>& u) const;
  /// uᵀ K u from the strains: twice the strain energy.
  [[nodiscard]] double energy(const Eigen::Ref<const Eigen::VectorXd>& u) const;
  /// Vᵀ K V, computed from the strains of the columns of V.
  [[nodiscard]] Eigen::MatrixXd projected_stiffness(const Eigen::MatrixXd& basis) const;
  /// The energy if no terms cancelled inside a strain; rounding errors are relative to it.
  [[nodiscard]] double uncancelled_energy(const Eigen::Ref<const Eigen::VectorXd>& u) const;
};

}  // namespace wheeltap::fem
