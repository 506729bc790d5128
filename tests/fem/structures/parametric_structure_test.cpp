#include "fem/structures/modes/parametric_structure.hpp"

#include <gtest/gtest.h>

#include "base/eigen_solvers.hpp"
#include "tests/fem/structures/parametric_structures.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::MatrixXd;
using Form = ParametricStructure::Form;

const std::vector<std::array<double, 2>> kMaterialChoices = {
    {150e9, 250e9}, {50e9, 90e9}, {7000.0, 8500.0}};

/// Compares K(θ) u and M(θ) u with the assembled matrices, and the lower bound with its definition.
void expect_right(const ParametricStructure& structure,
                  const std::vector<std::vector<double>>& points, bool with_floor) {
  for (const auto& theta : points) {
    const Discretisation d = structure.assemble(theta);
    const auto point = structure.at(theta);
    const MatrixXd u = MatrixXd::Random(d.size(), 3);
    const MatrixXd stiffness(d.stiffness);
    EXPECT_LT((structure.stiffness_times(point, u) - stiffness * u).norm(),
              1e-10 * (stiffness * u).norm());
    EXPECT_LT((structure.mass_times(point, u) - d.mass * u).norm(), 1e-10 * (d.mass * u).norm());
    EXPECT_LT((MatrixXd(structure.assemble(point).mass) - MatrixXd(d.mass)).norm(),
              1e-10 * MatrixXd(d.mass).norm());
    if (with_floor) {
      EXPECT_GT(point.floor, 0.0);
      const MatrixXd& c = structure.low_rank();
      ASSERT_EQ(point.excess.size(), c.cols());
      const MatrixXd nominal =
          MatrixXd(structure.nominal().stiffness) + c * point.excess.asDiagonal() * c.transpose();
      const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ratio(stiffness, nominal);
      EXPECT_GE(ratio.eigenvalues()[0], point.floor * (1.0 - 1e-4));
    }
  }
}

TEST(ParametricStructure, UnknownMaterialsAreAffine) {
  const auto points = parametric::draws(kMaterialChoices, 6, 1);
  const ParametricStructure structure(parametric::portal_materials(), points);
  EXPECT_EQ(structure.form(), Form::affine);
  EXPECT_TRUE(structure.mass_changes());
  EXPECT_EQ(structure.terms(), 3) << "posts, beam, and the spring that nothing changes";
  expect_right(structure, parametric::draws(kMaterialChoices, 3, 2), true);
}

TEST(ParametricStructure, ProjectedTermsAddUpToTheProjectedWhole) {
  const auto points = parametric::draws(kMaterialChoices, 6, 1);
  const ParametricStructure structure(parametric::portal_materials(), points);
  const MatrixXd basis = MatrixXd::Random(structure.nominal().size(), 5);
  const auto terms = structure.project_terms(basis);
  const auto point = structure.at(points[2]);
  MatrixXd sum = MatrixXd::Zero(5, 5);
  for (std::size_t t = 0; t < terms.size(); ++t)
    sum += point.scales[static_cast<Eigen::Index>(t)] * terms[t];
  const MatrixXd whole = structure.assemble(points[2]).projected_stiffness(basis);
  EXPECT_LT((sum - whole).norm(), 1e-12 * whole.norm());
}

TEST(ParametricStructure, AnUnknownHeightHasTheScaledForm) {
  const StructureFamily family{
      .at =
          [](std::span<const double> x) {
            return Mesh(parametric::portal(200e9, 70e9, 7800.0, x[0])).discretisation();
          },
      .nominal = {0.01}};
  const auto points = parametric::draws({{0.005, 0.02}}, 6, 1);
  const ParametricStructure structure(family, points);
  EXPECT_EQ(structure.form(), Form::scaled);
  expect_right(structure, parametric::draws({{0.005, 0.02}}, 3, 2), true);
}

TEST(ParametricStructure, AnAxialForceHasNoLowerBound) {
  const StructureFamily family{
      .at =
          [](std::span<const double> x) {
            return Mesh(parametric::portal(200e9, 70e9, 7800.0, 0.01, x[0])).discretisation();
          },
      .nominal = {-100.0}};
  const auto points = parametric::draws({{-200.0, -50.0}}, 6, 1);
  const ParametricStructure structure(family, points);
  EXPECT_EQ(structure.at(points[0]).floor, 0.0);
  expect_right(structure, points, false);
}

TEST(ParametricStructure, MatrixPartsAreTermsAndIndefiniteOnesHaveNoLowerBound) {
  const std::vector<std::array<double, 2>> box = {{-0.3, 0.3}, {-0.3, 0.3}, {-0.5, 2.0}};
  MatrixStructure floors = parametric::floors(4);
  const auto points = parametric::draws(box, 6, 1);
  const ParametricStructure structure(parametric::family_of(floors), points);
  EXPECT_EQ(structure.form(), Form::affine);
  EXPECT_FALSE(structure.mass_changes());
  EXPECT_EQ(structure.terms(), 3);
  expect_right(structure, points, true);
  // The same sum with one part that is not a stiffness.
  floors.parts[0].stiffness += 2.0 * floors.parts[1].stiffness;
  floors.parts[1].stiffness *= -1.0;
  const ParametricStructure indefinite(parametric::family_of(floors),
                                       parametric::draws({{-.1, .1}, {-.1, .1}, {-.1, .1}}, 6, 1));
  EXPECT_EQ(indefinite.at(std::vector<double>{0.1, 0.0, 0.0}).floor, 0.0);
}

}  // namespace
}  // namespace wheeltap::fem
