#include "fem/structures/reanalysis/residual_flexibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "braced_portal.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/reanalysis/structure_spectrum.hpp"

namespace wheeltap::fem {
namespace {

Structure portal_of(int dimension, bool free) {
  Structure s = braced_portal(dimension == 2 ? 12 : 6, dimension);
  if (free) s.supports.clear();
  return s;
}

/// Compares R_n of all pairs of some forms with their sums over all omitted modes. Returns the
/// worst error over the geometric mean of both forms' own values.
double worst_flexibility_error(const Mesh& mesh, const StructureSpectrum& all, int kept) {
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const ResidualFlexibility residual(d, all.shapes.leftCols(kept).cast<double>(),
                                     all.eigenvalues.head(kept), std::size_t{1} << 28);
  std::mt19937_64 random(3);
  std::vector<ResidualFlexibility::Form> forms;
  std::vector<Eigen::VectorXd> loads;
  const auto add = [&](ResidualFlexibility::Form form) {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(d->size());
    const auto strains = static_cast<int>(d->strains.size());
    for (const auto& [basic, weight] : form) {
      if (basic >= strains) {
        load[basic - strains] += weight;
        continue;
      }
      const SparseRow& row = d->strains[static_cast<std::size_t>(basic)].row;
      for (std::size_t i = 0; i < row.dofs.size(); ++i)
        load[row.dofs[i]] += weight * row.coefficients[i];
    }
    forms.push_back(std::move(form));
    loads.push_back(std::move(load));
  };
  for (int i = 0; i < 12; ++i) {
    const auto strain =
        std::uniform_int_distribution<int>(0, static_cast<int>(d->strains.size()) - 2)(random);
    add({{ResidualFlexibility::strain(strain), 1.0}});
    add({{ResidualFlexibility::strain(strain), 0.6},
         {ResidualFlexibility::strain(strain + 1), 0.8}});
    add({{residual.dof(
              std::uniform_int_distribution<int>(0, static_cast<int>(d->size()) - 1)(random)),
          1.0}});
  }
  add(residual.motion(mesh.motion(3, 1.1, Direction::x)));
  const Eigen::Index rest = all.eigenvalues.size() - kept;
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  std::vector<Wide> modal;
  for (const Eigen::VectorXd& load : loads)
    modal.push_back(all.shapes.rightCols(rest).transpose() * load.cast<long double>());
  const Wide inverse = all.eigenvalues.tail(rest).cast<long double>().cwiseInverse();
  double worst = 0.0;
  const auto exact = [&](std::size_t a, std::size_t b, int n) {
    long double sum = 0;
    for (Eigen::Index j = 0; j < rest; ++j)
      sum += modal[a][j] * modal[b][j] * std::pow(inverse[j], static_cast<long double>(n + 1));
    return static_cast<double>(sum);
  };
  for (std::size_t a = 0; a < forms.size(); ++a)
    for (std::size_t b = 0; b < forms.size(); ++b) {
      const ResidualFlexibility::Moments found = residual.moments(forms[a], forms[b]);
      for (int n = 0; n < 4; ++n)
        worst = std::max(worst, std::abs(found.r[n] - exact(a, b, n)) /
                                    std::sqrt(exact(a, a, n) * exact(b, b, n)));
    }
  return worst;
}

TEST(ResidualFlexibility, EqualsTheSumOverTheOmittedModes) {
  for (const int dimension : {2, 3})
    for (const bool free : {false, true}) {
      const Mesh mesh(portal_of(dimension, free));
      const StructureSpectrum all = structure_spectrum(mesh.discretisation(), 0);
      for (const int kept : {10, 20, 40}) {
        const double worst = worst_flexibility_error(mesh, all, kept);
        std::cout << dimension << (free ? " free, " : " held, ") << kept << " of "
                  << mesh.discretisation().size() << " modes: " << worst << "\n";
        EXPECT_LT(worst, 1e-10);
      }
    }
}

TEST(StaticCondensation, PartAndEdgeReproduceTheLoad) {
  const Mesh mesh(portal_of(2, true));
  const Discretisation& d = mesh.discretisation();
  const StaticCondensation parts(d, 1e6);
  EXPECT_GT(parts.parts(), 3);
  EXPECT_LT(parts.boundary().size(), static_cast<std::size_t>(d.size()) / 3);
  for (std::size_t s = 0; s < d.strains.size(); s += 5) {
    const StaticCondensation::Local local = parts.local(d.strains[s].row);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(d.size());
    for (std::size_t i = 0; i < d.strains[s].row.dofs.size(); ++i)
      load[d.strains[s].row.dofs[i]] = d.strains[s].row.coefficients[i];
    for (std::size_t n = 0; n < local.motion.size(); ++n) {
      Eigen::VectorXd motion = Eigen::VectorXd::Zero(d.size()), met = motion;
      for (std::size_t i = 0; i < local.inside.size(); ++i)
        motion[local.inside[i]] = local.motion[n][static_cast<Eigen::Index>(i)];
      met = d.stiffness_times(motion);
      for (std::size_t e = 0; e < local.edge.size(); ++e)
        met[parts.boundary()[static_cast<std::size_t>(local.edge[e])]] +=
            local.forces[n][static_cast<Eigen::Index>(e)];
      EXPECT_LT((met - load).norm(), 1e-10 * load.norm()) << s << ", " << n;
      load = d.mass * motion;
    }
  }
  EXPECT_THROW(
      (void)parts.local({.dofs = {0, static_cast<int>(d.size()) - 1}, .coefficients = {1.0, 1.0}}),
      std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::fem
