#include "fem/structures/modes/subspace_modes.hpp"

#include <gtest/gtest.h>

#include "base/eigen_solvers.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/defects/structure_defects.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "parametric_structures.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;

/// Largest relative error of an eigenvalue, and of a shape by its angle in the mass norm.
struct Errors {
  double eigenvalue = 0.0, shape = 0.0;
};
Errors errors(const Discretisation& d, const SubspaceModes::Found& found) {
  const Index rigid = d.rigid_motions.cols(), modes = found.eigenvalues.size();
  const StructureModes full = structure_modes(d, static_cast<int>(rigid + modes));
  Errors out;
  for (Index i = 0; i < modes; ++i) {
    out.eigenvalue = std::max(out.eigenvalue,
                              std::abs(found.eigenvalues[i] / full.eigenvalues[rigid + i] - 1.0));
    const double along =
        found.shapes.col(i).dot(Eigen::VectorXd(d.mass * full.shapes.col(rigid + i)));
    EXPECT_NEAR(found.shapes.col(i).dot(Eigen::VectorXd(d.mass * found.shapes.col(i))), 1.0, 1e-9);
    out.shape = std::max(out.shape, 1.0 - along * along);
  }
  return out;
}

// From the modes of the nominal frame to those of frames with other moduli, heights, masses and
// damage.
TEST(SubspaceModes, FindsTheModesOfChangedFrames) {
  const Mesh nominal(parametric::portal(200e9, 70e9, 7800.0, 0.01));
  const SubspaceModes solver(nominal.discretisation(), {.modes = 6, .tolerance = 1e-9});
  ASSERT_GT(nominal.discretisation().size(), SubspaceModes::kDense);
  SubspaceModes::Found found;
  for (const auto& x : parametric::draws(
           {{100e9, 300e9}, {40e9, 120e9}, {6000.0, 9000.0}, {0.006, 0.016}, {0.0, 0.95}}, 20, 1)) {
    const Mesh mesh(parametric::portal(x[0], x[1], x[2], x[3]));
    const Discretisation d = changed(
        mesh.discretisation(), change_of(mesh,
                                         {.elements = {{.member = 0, .at = x[4], .reduction = 0.9}},
                                          .masses = {{.member = 1, .at = 0.4, .mass = 1.5}}},
                                         {}));
    ASSERT_TRUE(solver.solve(d, found));
    EXPECT_GT(found.steps, 1);
    const Errors e = errors(d, found);
    EXPECT_LT(e.eigenvalue, 2e-8);
    EXPECT_LT(e.shape, 1e-6);
  }
}

TEST(SubspaceModes, ExcludesRigidMotions) {
  const auto family = parametric::shear_chain(60, false);
  const SubspaceModes solver(family.at(std::vector<double>{1000.0, 1200.0}), {.modes = 4});
  SubspaceModes::Found found;
  const Discretisation d = family.at(std::vector<double>{700.0, 2000.0});
  ASSERT_TRUE(solver.solve(d, found));
  EXPECT_LT(errors(d, found).eigenvalue, 1e-7);
  // Few degrees of freedom: solved densely.
  const auto small = parametric::shear_chain(5, false);
  const SubspaceModes dense(small.at(std::vector<double>{1000.0, 1200.0}), {.modes = 4});
  const Discretisation other = small.at(std::vector<double>{300.0, 5000.0});
  ASSERT_TRUE(dense.solve(other, found));
  EXPECT_EQ(found.steps, 0);
  EXPECT_LT(errors(other, found).eigenvalue, 1e-10);
}

// A rigid support leaves fewer degrees of freedom than the first structure has.
TEST(SubspaceModes, SolvesInFullIfDegreesOfFreedomDiffer) {
  const Mesh mesh(parametric::portal(200e9, 70e9, 7800.0, 0.01));
  const SubspaceModes solver(mesh.discretisation(), {.modes = 4});
  StructureChange change;
  change.springs.push_back({.motion = mesh.motion(1, 0.7, Direction::y),
                            .stiffness = std::numeric_limits<double>::infinity()});
  const Discretisation d = changed(mesh.discretisation(), change);
  SubspaceModes::Found found;
  ASSERT_TRUE(solver.solve(d, found));
  EXPECT_LT(errors(d, found).eigenvalue, 1e-9);
}

TEST(SubspaceModes, AcceptsDegreesOfFreedomWithoutMass) {
  const MatrixStructure s = parametric::floors(20);
  const SubspaceModes solver(discretise(s), {.modes = 5});
  MatrixStructure softer = s;
  softer.parts[1].change = -0.4;
  const Discretisation d = discretise(softer);
  SubspaceModes::Found found;
  ASSERT_TRUE(solver.solve(d, found));
  EXPECT_LT(errors(d, found).eigenvalue, 1e-7);
}

TEST(SubspaceModes, ReturnsFalseWithoutAStructure) {
  const auto buckled = Mesh(parametric::portal(200e9, 70e9, 7800.0, 0.01, -1e6)).discretisation();
  const SubspaceModes solver(Mesh(parametric::portal(200e9, 70e9, 7800.0, 0.01)).discretisation(),
                             {.modes = 3});
  SubspaceModes::Found found;
  EXPECT_FALSE(solver.solve(buckled, found));
  const auto two = parametric::shear_chain(2).at(std::vector<double>{1000.0, 1200.0});
  EXPECT_THROW(SubspaceModes(two, {.modes = 3}), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::fem
