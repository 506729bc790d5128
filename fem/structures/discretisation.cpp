#include "fem/structures/discretisation.hpp"

#include "base/eigen_solvers.hpp"

namespace wheeltap::fem {

std::vector<char> Discretisation::holding_dofs() const {
  std::vector<char> held(static_cast<std::size_t>(size()), 0);
  if (rigid_motions.cols() == 0) return held;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rigid_motions.transpose());
  for (Eigen::Index r = 0; r < rigid_motions.cols(); ++r)
    held[static_cast<std::size_t>(qr.colsPermutation().indices()[r])] = 1;
  return held;
}

Eigen::VectorXd Discretisation::stiffness_times(const Eigen::Ref<const Eigen::VectorXd>& u) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(size());
  if (rest.nonZeros() > 0) out = rest * u;
  for (const Strain& strain : strains) {
    const double stress = strain.factor * strain.row.of(u);
    for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
      out[strain.row.dofs[i]] += strain.row.coefficients[i] * stress;
  }
  return out;
}

double Discretisation::energy(const Eigen::Ref<const Eigen::VectorXd>& u) const {
  double sum = rest.nonZeros() > 0 ? u.dot(rest * u) : 0.0;
  for (const Strain& strain : strains) {
    const double e = strain.row.of(u);
    sum += strain.factor * e * e;
  }
  return sum;
}

Eigen::MatrixXd Discretisation::projected_stiffness(const Eigen::MatrixXd& basis) const {
  const Eigen::Index m = basis.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(m, m);
  Eigen::VectorXd strain(m);
  for (const Strain& s : strains) {
    strain.setZero();
    for (std::size_t i = 0; i < s.row.dofs.size(); ++i)
      strain += s.row.coefficients[i] * basis.row(s.row.dofs[i]).transpose();
    sum.selfadjointView<Eigen::Lower>().rankUpdate(strain, s.factor);
  }
  if (rest.nonZeros() > 0) {
    const Eigen::MatrixXd of_rest = basis.transpose() * (rest * basis);
    sum += 0.5 * (of_rest + of_rest.transpose());
  }
  return sum.selfadjointView<Eigen::Lower>();
}

double Discretisation::uncancelled_energy(const Eigen::Ref<const Eigen::VectorXd>& u) const {
  double sum = rest.nonZeros() > 0 ? u.cwiseAbs().dot(rest.cwiseAbs() * u.cwiseAbs()) : 0.0;
  for (const Strain& strain : strains) {
    double e = 0.0;
    for (std::size_t i = 0; i < strain.row.dofs.size(); ++i)
      e += std::abs(strain.row.coefficients[i] * u[strain.row.dofs[i]]);
    sum += e * e;
  }
  return sum;
}

}  // namespace wheeltap::fem
