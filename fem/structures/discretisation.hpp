// The matrices of K φ = ω² M φ, and the strains that they are made of.
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

/// What stores no strains of its own: a degree of freedom by name, for messages and sensors.
struct DofName {
  std::string place;  ///< a node, or a place on a member
  std::string direction;
};

/// K φ = λ M φ in the n degrees of freedom that are free. K = Bᵀ D B + K_rest from the strains B,
/// so that φᵀ K φ is a sum of squares, which does not cancel as the assembled matrix does for
/// smooth shapes of fine meshes.
struct Discretisation {
  using Sparse = Eigen::SparseMatrix<double>;

  std::vector<DofName> names;      ///< n
  std::vector<Strain> strains;     ///< the rows of B
  Sparse rest;                     ///< K_rest, n × n: what is given as a matrix (or empty)
  std::vector<Sparse> parts = {};  ///< whose sum it is; empty where it is not told apart
  Sparse stiffness;                ///< K, n × n, both triangles
  Sparse mass;                     ///< M, n × n, positive semidefinite
  Eigen::MatrixXd rigid_motions;   ///< n × r: motions that strain nothing, any basis

  [[nodiscard]] Eigen::Index size() const { return mass.rows(); }
  /// n marks: as many degrees of freedom as there are rigid motions, and they hold all of those.
  [[nodiscard]] std::vector<char> holding_dofs() const;
  /// K u by the strains.
  [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::Ref<const Eigen::VectorXd>& u) const;
  /// uᵀ K u by the strains: twice the strain energy.
  [[nodiscard]] double energy(const Eigen::Ref<const Eigen::VectorXd>& u) const;
  /// Vᵀ K V of the columns of V, by the strains.
  [[nodiscard]] Eigen::MatrixXd projected_stiffness(const Eigen::MatrixXd& basis) const;
  /// The energy, had nothing cancelled inside each strain: what rounding is measured by.
  [[nodiscard]] double uncancelled_energy(const Eigen::Ref<const Eigen::VectorXd>& u) const;
};

}  // namespace wheeltap::fem
