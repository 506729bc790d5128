#include "identification/modal/real_shape.hpp"

#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

double estimated_covariance_factor(int numbers, int blocks) {
  if (blocks == 0) return 1.0;
  if (blocks < 2 * numbers + 3) return 0.0;
  const double n = blocks, p = numbers;
  if (numbers < 2) return (n - 1.0) / (n - p - 2.0);  // one quantity: no weights
  const double inverse = (n - 1.0) / (n - p - 2.0);
  const double weights = (n - p - 2.0) / ((n - p - 1.0) * (n - p - 4.0));
  return inverse * (1.0 + weights * (p - 1.0));
}

RealShape real_shape(const VectorXcd& shape, const MatrixXd& covariance, int blocks) {
  const Index m = shape.size();
  if (m < 2)
    throw std::invalid_argument("a shape needs at least 2 entries, has " + std::to_string(m));
  if (covariance.rows() != 2 * m || covariance.cols() != 2 * m)
    throw std::invalid_argument("the covariance must be " + std::to_string(2 * m) + " x " +
                                std::to_string(2 * m) + ": real, then imaginary parts");
  if (!shape.allFinite() || !covariance.allFinite())
    throw std::invalid_argument("a shape and its covariance must be finite");
  const std::complex<double> squares = (shape.transpose() * shape)(0, 0);
  if (!(shape.squaredNorm() > 0.0))
    throw std::invalid_argument("a shape must have an entry other than 0");
  const std::complex<double> turn = std::polar(1.0, -0.5 * std::arg(squares));
  const VectorXcd turned = turn * shape;
  const double largest = turned.real().cwiseAbs().maxCoeff();

  // Jacobian J that maps (dRe ψ, dIm ψ) to dy.
  MatrixXd slopes(m, 2 * m);
  slopes << turn.real() * MatrixXd::Identity(m, m), -turn.imag() * MatrixXd::Identity(m, m);
  if (std::abs(squares) > 0.0) {
    const VectorXcd by = shape / squares;
    Eigen::RowVectorXd angle(2 * m);
    angle << by.imag().transpose(), by.real().transpose();
    slopes += turned.imag() * angle;
  }
  RealShape out{.values = turned.real() / largest,
                .covariance = slopes * covariance * slopes.transpose() / (largest * largest),
                .imaginary = turned.imag().norm() / turned.real().norm()};

  const VectorXd along = out.values.normalized();
  const MatrixXd across = MatrixXd::Identity(m, m) - along * along.transpose();
  MatrixXd plane = across * out.covariance * across;
  const double factor = estimated_covariance_factor(static_cast<int>(m - 1), blocks);
  out.correlated = factor > 0.0;
  if (out.correlated) {
    plane *= factor;
    const double mean = plane.trace() / static_cast<double>(m - 1);
    out.covariance = 0.5 * (plane + plane.transpose()) + mean * along * along.transpose();
  } else {
    out.covariance = plane.diagonal().asDiagonal();
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(out.covariance, Eigen::EigenvaluesOnly);
  if (!(solver.eigenvalues()[0] > 1e-13 * solver.eigenvalues()[m - 1]))
    throw std::invalid_argument("the covariance of a shape must be positive definite");
  return out;
}

}  // namespace wheeltap::identification
