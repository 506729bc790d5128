#include "identification/monitoring/charts/cointegration.hpp"

#include "base/eigen_solvers.hpp"

namespace wheeltap::identification::monitoring {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd cointegrating_vector(const MatrixXd& levels) {
  const Index n = levels.rows() - 2, p = levels.cols();
  const MatrixXd differences = levels.bottomRows(n + 1) - levels.topRows(n + 1);
  MatrixXd z0 = differences.bottomRows(n), z1 = levels.middleRows(1, n), z2(n, p + 1);
  z2 << VectorXd::Ones(n), differences.topRows(n);
  const Eigen::ColPivHouseholderQR<MatrixXd> regression(z2);
  const MatrixXd b0 = regression.solve(z0), b1 = regression.solve(z1);
  z0 -= z2 * b0;
  z1 -= z2 * b1;
  const double rows = static_cast<double>(n);
  const MatrixXd s00 = z0.transpose() * z0 / rows, s01 = z0.transpose() * z1 / rows;
  const MatrixXd s11 = z1.transpose() * z1 / rows;
  const Eigen::LLT<MatrixXd> factor(s11);
  // With S11 = L L' and c = L' b: L⁻¹ S10 S00⁻¹ S01 L⁻ᵀ c = λ c.
  const MatrixXd right = s01.transpose() * Eigen::LDLT<MatrixXd>(s00).solve(s01);
  MatrixXd m = factor.matrixL().solve(right);
  m = factor.matrixL().solve(m.transpose().eval());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(MatrixXd(0.5 * (m + m.transpose())));
  return factor.matrixU().solve(eigen.eigenvectors().col(p - 1).eval());
}

}  // namespace wheeltap::identification::monitoring
