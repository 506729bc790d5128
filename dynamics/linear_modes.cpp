#include "dynamics/linear_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/eigen_solvers.hpp"

namespace wheeltap::dynamics {

std::vector<LinearMode> linear_modes(const Chain& chain, std::span<const double> theta) {
  const LinearMatrices m = linear_matrices(chain, theta);
  const Eigen::Index n = m.mass.rows();
  const Eigen::VectorXd inverse_mass = m.mass.diagonal().cwiseInverse();
  // 1 / rate is the unit of time. In this unit, M⁻¹ K and M⁻¹ C are of order 1.
  const double rate = std::max(std::sqrt((inverse_mass.asDiagonal() * m.stiffness).norm()),
                               (inverse_mass.asDiagonal() * m.damping).norm());
  if (!(rate > 0.0)) return {};
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n).setIdentity();
  state.bottomLeftCorner(n, n) = -(inverse_mass.asDiagonal() * m.stiffness) / (rate * rate);
  state.bottomRightCorner(n, n) = -(inverse_mass.asDiagonal() * m.damping) / rate;
  const Eigen::VectorXcd eigenvalues = state.eigenvalues();
  constexpr double kRounding =
      1e-6;  // rounding splits a defective double eigenvalue 0 by √ε · rate
  std::vector<LinearMode> modes;
  for (const std::complex<double>& lambda : eigenvalues) {
    if (!(lambda.imag() > kRounding)) continue;
    modes.push_back({.frequency_hz = rate * std::abs(lambda) / (2.0 * std::numbers::pi),
                     .damping_ratio = -lambda.real() / std::abs(lambda)});
  }
  std::ranges::sort(modes, {}, &LinearMode::frequency_hz);
  return modes;
}

}  // namespace wheeltap::dynamics
