#include "signals/modal/shape_quantities.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "signals/refuse.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// The real matrix of a complex matrix m, for vectors of real parts, then imaginary parts.
MatrixXd in_parts(const MatrixXcd& m) {
  MatrixXd out(2 * m.rows(), 2 * m.cols());
  out << m.real(), -m.imag(), m.imag(), m.real();
  return out;
}

}  // namespace

void convert_shapes(ModalResult& result, std::span<const int> orders) {
  if (orders.empty()) return;
  const auto [lowest, highest] = std::ranges::minmax(orders);
  if (lowest == highest) return;
  for (Mode& mode : result.modes) {
    const auto n = mode.pole.shape.size();
    if (n != std::ssize(orders))
      refuse("orders", static_cast<int>(orders.size()), "must be one per channel");
    const double omega = 2.0 * std::numbers::pi * mode.pole.frequency_hz;
    const double damping =
        std::isfinite(mode.pole.damping) ? std::clamp(mode.pole.damping, -0.99, 0.99) : 0.0;
    const std::complex<double> lambda =
        omega * std::complex<double>(-damping, std::sqrt(1.0 - damping * damping));
    Eigen::VectorXcd factor(n);
    for (Index i = 0; i < n; ++i)
      factor[i] = std::pow(lambda, highest - orders[static_cast<std::size_t>(i)]);
    const Eigen::VectorXcd shape = factor.cwiseProduct(mode.pole.shape);
    Index largest = 0;
    if (!(shape.cwiseAbs().maxCoeff(&largest) > 0.0)) continue;
    mode.pole.shape = shape / shape[largest];
    if (mode.shape_covariance.size() > 0) {
      // z = y / y_m, dz = (dy - z dy_m) / y_m, dy = D dx.
      MatrixXcd move = MatrixXcd::Identity(n, n);
      move.col(largest) -= mode.pole.shape;
      move = (move / shape[largest]) * factor.asDiagonal();
      const MatrixXd parts = in_parts(move);
      mode.shape_covariance = parts * mode.shape_covariance * parts.transpose();
    }
    mode.collinearity = phase_collinearity(mode.pole.shape);
    mode.phase_deviation = mean_phase_deviation(mode.pole.shape);
    std::erase(mode.doubts, ModeDoubt::complex_shape);
    if (mode.collinearity < kCollinear) mode.doubts.push_back(ModeDoubt::complex_shape);
  }
}

}  // namespace wheeltap::signals
