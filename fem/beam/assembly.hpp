// Assembly of the matrices of K φ = ω² M φ for a beam with defects.
#pragma once

#include <Eigen/SparseCore>

#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"
#include "fem/beam/timoshenko_element.hpp"

namespace wheeltap::fem {

/// Deflection w(x) or rotation θ(x) at one location, as a linear combination of four neighbouring
/// degrees of freedom: coefficients · u[first_dof .. first_dof + 4). At a node, only one
/// coefficient is nonzero.
template <class Real>
struct MotionRow {
  int first_dof;
  Eigen::Matrix<Real, 4, 1> coefficients;
};

/// Computes the coefficients of w(x) or θ(x) from the element's shape functions. The result is
/// exact at nodes. A location within 1e-9 L of a node counts as this node. Throws
/// std::invalid_argument if x is outside the beam.
template <class Real>
[[nodiscard]] MotionRow<Real> motion_row(const Beam& beam, const TimoshenkoElement<Real>& element,
                                         double x, bool rotation);

/// Computes the fraction of each element's stiffness that remains after its reductions r: Π (1 -
/// r). The product is accurate even if little stiffness remains; in this case, 1 minus the lost
/// fraction would have no correct digits.
template <class Real>
[[nodiscard]] Eigen::Matrix<Real, Eigen::Dynamic, 1> remaining_stiffness(const Beam& beam,
                                                                         const Defects& defects);

/// Returns the number of rigid-body modes of the beam with its supports and the added supports: at
/// most two (translation and rotation).
[[nodiscard]] int rigid_body_freedom(const Beam& beam, std::span<const SpringSupport> added);

/// The eigenvalue problem in the free degrees of freedom q, with u = T q. A rigid support N(x) · u
/// = 0 eliminates one degree of freedom. The other degrees of freedom of the element determine the
/// eliminated one, so K and M remain sparse.
template <class Real>
struct Assembly {
  using Sparse = Eigen::SparseMatrix<Real>;
  Sparse stiffness;            ///< Tᵀ K T, n × n, symmetric (both triangles)
  Sparse mass;                 ///< Tᵀ M T, n × n
  Sparse free_to_all;          ///< T, 2 (elements + 1) × n
  std::vector<int> free_dofs;  ///< index, in the mesh, of each entry of q
};

/// Assembles the eigenvalue problem. Throws std::invalid_argument for an invalid beam, and for a
/// defect outside the beam or with a value out of range.
template <class Real>
[[nodiscard]] Assembly<Real> assemble(const Beam& beam, const Defects& defects);

/// Throws std::invalid_argument for a damage outside the beam or with a reduction outside [0, 1).
void validate(const Beam& beam, const Damage& damage);
/// Throws std::invalid_argument for a support outside the beam or with a stiffness that is not
/// positive.
void validate(const Beam& beam, const SpringSupport& support);

}  // namespace wheeltap::fem
