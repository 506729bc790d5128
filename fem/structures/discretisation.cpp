#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

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
