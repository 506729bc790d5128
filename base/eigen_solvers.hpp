// Eigen's decompositions of dense matrices of variable size, compiled once (eigen_solvers.cpp).
//
// Include this in place of <Eigen/Dense>, <Eigen/Cholesky>, <Eigen/LU>, <Eigen/QR>, <Eigen/SVD> and
// <Eigen/Eigenvalues>: a source file that takes a decomposition then does not compile it. Pass the
// decomposition a matrix, not an expression, where the expression is not needed otherwise.
#pragma once

#include <Eigen/Dense>
#include <complex>

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
WHEELTAP_SOLVER_INSTANCE template class CompleteOrthogonalDecomposition<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class JacobiSVD<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class BDCSVD<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class SelfAdjointEigenSolver<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template SelfAdjointEigenSolver<MatrixXd>&
SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
WHEELTAP_SOLVER_INSTANCE template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template class EigenSolver<MatrixXd>;
WHEELTAP_SOLVER_INSTANCE template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, bool);

WHEELTAP_SOLVER_INSTANCE template class PartialPivLU<MatrixXcd>;
WHEELTAP_SOLVER_INSTANCE template class FullPivLU<MatrixXcd>;
WHEELTAP_SOLVER_INSTANCE template class HouseholderQR<MatrixXcd>;
WHEELTAP_SOLVER_INSTANCE template class JacobiSVD<MatrixXcd>;
WHEELTAP_SOLVER_INSTANCE template class SelfAdjointEigenSolver<MatrixXcd>;
WHEELTAP_SOLVER_INSTANCE template SelfAdjointEigenSolver<MatrixXcd>&
SelfAdjointEigenSolver<MatrixXcd>::compute(const EigenBase<MatrixXcd>&, int);
WHEELTAP_SOLVER_INSTANCE template class ComplexEigenSolver<MatrixXcd>;
WHEELTAP_SOLVER_INSTANCE template ComplexEigenSolver<MatrixXcd>&
ComplexEigenSolver<MatrixXcd>::compute(const EigenBase<MatrixXcd>&, bool);

// What the decompositions of expressions come down to.
namespace internal {
WHEELTAP_SOLVER_INSTANCE template void tridiagonalization_inplace(MatrixXd&, VectorXd&);
WHEELTAP_SOLVER_INSTANCE template void make_block_householder_triangular_factor(
    Matrix<double, Dynamic, Dynamic, RowMajor>&, const Block<MatrixXd, Dynamic, Dynamic>&,
    const VectorBlock<const VectorXd>&);
}  // namespace internal

}  // namespace Eigen
#endif
