// Eigenvalues of symmetric tridiagonal matrices with one component of each eigenvector.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::fem {

/// Computes the eigenvalues (ascending) of a symmetric tridiagonal matrix T, and the last
/// component of each unit eigenvector. `diagonal` holds the n >= 1 diagonal entries of T, and
/// `below` holds the n - 1 entries below the diagonal:
///
///   T q_i = values_i q_i,   last_i = e_nᵀ q_i (up to the sign).
///
/// The method is implicit QL, which rotates only the last row of the eigenvectors and takes O(n²)
/// operations (Golub & Welsch 1969, Mathematics of Computation 23:221). Returns false if the
/// iteration does not converge. The entries must be finite.
bool last_components(Eigen::VectorXd diagonal, const Eigen::VectorXd& below,
                     Eigen::VectorXd& values, Eigen::VectorXd& last);

}  // namespace wheeltap::fem
