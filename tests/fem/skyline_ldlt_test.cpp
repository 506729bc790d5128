#include "fem/beam/skyline_ldlt.hpp"

#include <gtest/gtest.h>

#include "base/eigen_solvers.hpp"
#include "beams.hpp"
#include "fem/beam/assembly.hpp"

namespace wheeltap::fem {
namespace {

Assembly<double> some_problem() {
  Beam beam = slender_beam("clamped-pinned", 9);
  beam.supports.push_back({.at = 0.37, .stiffness = {}});  // off the nodes: widens the band
  return assemble<double>(beam, {});
}

TEST(SkylineLdlt, Solves) {
  const Assembly<double> a = some_problem();
  SkylineLdlt<double> ldlt(a.stiffness, a.mass);
  const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(ldlt.size(), 1.0, 2.0);
  const Eigen::SparseMatrix<double> shifted = a.stiffness - 1e5 * a.mass;
  Eigen::VectorXd x = shifted * expected;
  ldlt.factor(1e5);
  ldlt.solve(x);
  EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
}

TEST(SkylineLdlt, CountsEigenvaluesBelow) {
  const Assembly<double> a = some_problem();
  SkylineLdlt<double> ldlt(a.stiffness, a.mass);
  const Eigen::VectorXd eigenvalues = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                                          Eigen::MatrixXd(a.stiffness), Eigen::MatrixXd(a.mass))
                                          .eigenvalues();
  EXPECT_EQ(ldlt.factor(0.0), 0);
  for (int i = 0; i + 1 < ldlt.size(); ++i)
    EXPECT_EQ(ldlt.factor(0.5 * (eigenvalues[i] + eigenvalues[i + 1])), i + 1);
  EXPECT_EQ(ldlt.factor(2.0 * eigenvalues[ldlt.size() - 1]), ldlt.size());
}

TEST(SkylineLdlt, DetectsASingularLeadingBlock) {
  // Regression: σ = k₁₁ / m₁₁ gives a zero first pivot; the count missed a mode of a seven-element
  // beam.
  const Assembly<double> a = some_problem();
  SkylineLdlt<double> ldlt(a.stiffness, a.mass);
  const double sigma = a.stiffness.coeff(0, 0) / a.mass.coeff(0, 0);
  ldlt.factor(sigma);
  EXPECT_FALSE(ldlt.stable());
  ldlt.factor(1.01 * sigma);
  EXPECT_TRUE(ldlt.stable());
}

}  // namespace
}  // namespace wheeltap::fem
