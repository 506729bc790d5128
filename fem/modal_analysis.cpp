#include "fem/modal_analysis.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "fem/assembly.hpp"

namespace wheeltap::fem {

Modes modal_analysis(const Beam& beam, const Defects& defects, const ModalOptions& options) {
  const Assembly<double> a = assemble<double>(beam, defects);
  const Eigen::Index n = a.stiffness.rows();
  if (options.modes < 1 || options.modes > n)
    throw std::invalid_argument("modes = " + std::to_string(options.modes) +
                                ": must be between 1 and the " + std::to_string(n) +
                                " free degrees of freedom");
  const double shift = -beam.material.young * beam.section.second_moment /
                       (beam.material.density * beam.section.area * std::pow(beam.length, 4));
  const Eigen::MatrixXd k = Eigen::MatrixXd(a.stiffness), m = Eigen::MatrixXd(a.mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(m, k - shift * m);
  Modes modes;
  modes.rigid_body_modes = rigid_body_freedom(beam, defects);
  modes.solver = "dense";
  modes.eigenvalues.resize(options.modes);
  modes.shapes.resize(2 * beam.nodes(), options.modes);
  for (int i = 0; i < options.modes; ++i) {
    const Eigen::VectorXd q = solver.eigenvectors().col(n - 1 - i);
    modes.eigenvalues[i] =
        i < modes.rigid_body_modes ? 0.0 : 1.0 / solver.eigenvalues()[n - 1 - i] + shift;
    modes.shapes.col(i) = a.free_to_all * (q / std::sqrt(q.dot(m * q)));
  }
  modes.frequencies_hz = modes.eigenvalues.cwiseSqrt() / (2.0 * std::numbers::pi);
  return modes;
}

}  // namespace wheeltap::fem
