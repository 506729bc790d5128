// Eigen's decompositions of dense matrices of variable size, compiled once (eigen_solvers.cpp).
//
// Include this header instead of <Eigen/Dense>, <Eigen/Cholesky>, <Eigen/LU>, <Eigen/QR>,
// <Eigen/SVD> and <Eigen/Eigenvalues>; source files that include this header do not compile the
// decompositions. Pass a matrix, not an expression, to a decomposition: each decomposition of an
// expression is a further template instance. Decompositions that only one or two files use (complex
// matrices, JacobiSVD, EigenSolver) are compiled in those files.
#pragma once

#include <Eigen/Dense>

#include "base/eigen.hpp"

#ifdef WHEELTAP_EIGEN_INSTANCES
#ifndef WHEELTAP_SOLVER_INSTANCE
#define WHEELTAP_SOLVER_INSTANCE extern
#endif

namespace Eigen {

WHEELTAP_SOLVER_INSTANCE template class LLT<MatrixXd, Lower>;
WHEELTAP_SOLVER_INSTANCE template LLT<MatrixXd, Lower>& LLT<MatrixXd, Lower>::compute(
    const EigenBase<MatrixXd>&);
WHEELTAP_SOLVER_INSTANCE template class LDLT<MatrixXd, Lower>;
WHEELTAP_SOLVER_INSTANCE template LDLT<MatrixXd, Lower>& LDLT<MatrixXd, Lower>::compute(
    const EigenBase<MatrixXd>&);
WHEELTAP_SOLVER_INSTANCE template class PartialPivLU<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class FullPivLU<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class HouseholderQR<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class ColPivHouseholderQR<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&,
                                                                                  VectorXd&) const;
WHEELTAP_SOLVER_INSTANCE template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                                  MatrixXd&) const;
WHEELTAP_SOLVER_INSTANCE template class CompleteOrthogonalDecomposition<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template void HouseholderSequence<MatrixXd, VectorXd>::evalTo(
    MatrixXd&, VectorXd&) const;
WHEELTAP_SOLVER_INSTANCE template void HouseholderSequence<MatrixXd, VectorXd>::applyThisOnTheLeft(
    MatrixXd&, Matrix<double, 1, Dynamic, RowMajor>&, bool) const;
WHEELTAP_SOLVER_INSTANCE template class BDCSVD<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class SelfAdjointEigenSolver<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template SelfAdjointEigenSolver<MatrixXd>&
SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
WHEELTAP_SOLVER_INSTANCE template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;

// Functions that a decomposition calls if its argument is an expression instead of a matrix.
namespace internal {
WHEELTAP_SOLVER_INSTANCE template void tridiagonalization_inplace(MatrixXd&, VectorXd&);
WHEELTAP_SOLVER_INSTANCE template void make_block_householder_triangular_factor(
    Matrix<double, Dynamic, Dynamic, RowMajor>&, const Block<MatrixXd, Dynamic, Dynamic>&,
    const VectorBlock<const VectorXd>&);
}  // namespace internal

}  // namespace Eigen
#endif
