// The matrices of K φ = ω² M φ, and the strains from which they are assembled.
#pragma once

#include <Eigen/SparseCore>

#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// A linear form of the degrees of freedom: Σ coefficients[i] u[dofs[i]]. `dofs` is in ascending
/// order.
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

/// One strain; its energy is ½ factor (row · u)². The factor is 1, or -1 for the geometric
/// stiffness of a compressed member. The row contains the square root of the stiffness.
struct Strain {
  SparseRow row;
  double factor = 1.0;
};

/// The name of a degree of freedom, as used in messages and for sensors.
struct DofName {
  std::string place;  ///< a node, or a location on a member
  std::string direction;
};

/// The eigenvalue problem K φ = λ M φ in the n free degrees of freedom, K = Bᵀ D B + K_rest, B:
/// `strains`. φᵀ K φ is computed as a sum of squares of strains, without cancellation. The product
/// with the assembled K suffers from cancellation for smooth shapes on fine meshes.
struct Discretisation {
  using Sparse = Eigen::SparseMatrix<double>;

  std::vector<DofName> names;      ///< n
  std::vector<Strain> strains;     ///< the rows of B
  Sparse rest;                     ///< K_rest, n × n: the part of K that is given as a matrix; may
                                   ///< be empty
  std::vector<Sparse> parts = {};  ///< summands of `rest`; empty if they are not
                                   ///< distinguished
  Sparse stiffness;                ///< K, n × n, both triangles
  Sparse mass;                     ///< M, n × n, positive semidefinite
  Eigen::MatrixXd rigid_motions;   ///< n × r: any basis of the strain-free displacements

  [[nodiscard]] Eigen::Index size() const { return mass.rows(); }
  /// Selects degrees of freedom whose restraint prevents all rigid-body motions: as many degrees of
  /// freedom as there are independent rigid-body motions.
  [[nodiscard]] std::vector<char> holding_dofs() const;
  /// Computes K u from the strains.
  [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::Ref<const Eigen::VectorXd>& u) const;
  /// Computes uᵀ K u, twice the strain energy, from the strains.
  [[nodiscard]] double energy(const Eigen::Ref<const Eigen::VectorXd>& u) const;
  /// Computes Vᵀ K V from the strains of the columns of V.
  [[nodiscard]] Eigen::MatrixXd projected_stiffness(const Eigen::MatrixXd& basis) const;
  /// Computes the energy with the absolute values of all terms of each strain, so that no terms
  /// cancel. Rounding errors of `energy` are proportional to this value.
  [[nodiscard]] double uncancelled_energy(const Eigen::Ref<const Eigen::VectorXd>& u) const;
};

}  // namespace wheeltap::fem
