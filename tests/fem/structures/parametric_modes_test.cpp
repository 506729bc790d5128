#include "fem/structures/modes/parametric_modes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "fem/structures/modes/structure_modes.hpp"
#include "tests/fem/structures/parametric_structures.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Box = std::vector<std::array<double, 2>>;

/// Random points compared with full solutions: 300, or the number WHEELTAP_RANDOM_POINTS.
int random_points() {
  const char* text = std::getenv("WHEELTAP_RANDOM_POINTS");
  return text != nullptr ? std::atoi(text) : 300;
}

struct Reduced {
  std::shared_ptr<const ParametricStructure> structure;
  ParametricModes modes;
};

Reduced reduce(const StructureFamily& family, const Box& box, ParametricModesOptions options) {
  const auto training = parametric::draws(box, 100, 7);
  auto structure = std::make_shared<const ParametricStructure>(family, training);
  ParametricModes modes(structure, training, std::move(options));
  return {std::move(structure), std::move(modes)};
}

/// Full solutions at the same points.
void expect_within_bounds(const Reduced& reduced, const ParametricModesOptions& options,
                          const Box& box, int points) {
  auto workspace = reduced.modes.make_workspace();
  ParametricModes::Modes found;
  double worst = 0.0, worst_bound = 0.0, worst_shape = 0.0;
  int miscounted = 0;
  const auto rigid = static_cast<int>(reduced.structure->nominal().rigid_motions.cols());
  for (const auto& theta : parametric::draws(box, points, 99)) {
    reduced.modes.solve(theta, workspace, found);
    const Discretisation d = reduced.structure->assemble(theta);
    const StructureModes full = structure_modes(d, rigid + options.modes);
    for (Index i = 0; i < options.modes; ++i) {
      const double truth = full.eigenvalues[rigid + i];
      const double error = std::abs(found.eigenvalues[i] / truth - 1.0);
      EXPECT_LE(error, found.bounds[i] + 2e-10) << "mode " << i + 1;
      EXPECT_LE(found.bounds[i], options.tolerance);
      EXPECT_GT(found.eigenvalues[i] / truth - 1.0, -2e-10) << "Rayleigh quotients are above";
      worst = std::max(worst, error);
      worst_bound = std::max(worst_bound, found.bounds[i]);
      if (options.motions.empty()) continue;
      VectorXd shape(static_cast<Index>(options.motions.size()));
      for (Index s = 0; s < shape.size(); ++s)
        shape[s] = options.motions[static_cast<std::size_t>(s)].of(full.shapes.col(rigid + i));
      const VectorXd ours = found.shapes.col(i);
      const double size = std::max(shape.norm(), 1e-3);
      worst_shape =
          std::max(worst_shape, std::min((ours - shape).norm(), (ours + shape).norm()) / size);
    }
    miscounted += !full.certified;
  }
  const auto& training = reduced.modes.training();
  std::printf(
      "  %d points: largest error %.1e (bound %.1e), of shapes %.1e; basis %d from %d solves, %ld "
      "points in full\n",
      points, worst, worst_bound, worst_shape, training.basis, training.solved,
      workspace.solved_in_full());
  EXPECT_EQ(miscounted, 0);
  EXPECT_EQ(training.miscounted, 0);
  EXPECT_LE(workspace.solved_in_full(), points / 20) << "the basis serves nearly all of the box";
  EXPECT_LT(worst_shape, 5e-3);
}

const Box kMaterials = {{150e9, 250e9}, {50e9, 90e9}, {7000.0, 8500.0}};

std::vector<SparseRow> some_motions(const Discretisation& d, int step) {
  std::vector<SparseRow> motions;
  for (int i = 0; i < d.size(); i += step) motions.push_back({.dofs = {i}, .coefficients = {1.0}});
  return motions;
}

class ParametricSolvers : public testing::TestWithParam<ParametricSolver> {};

INSTANTIATE_TEST_SUITE_P(Both, ParametricSolvers,
                         testing::Values(ParametricSolver::basis, ParametricSolver::sparse),
                         [](const auto& param_info) {
                           return param_info.param == ParametricSolver::basis ? "Basis" : "Sparse";
                         });

TEST_P(ParametricSolvers, BoundsHoldForAFrameWithUnknownMaterials) {
  const StructureFamily family = parametric::portal_materials();
  const Discretisation d = family.at(family.nominal);
  const ParametricModesOptions options{
      .modes = 8, .motions = some_motions(d, 31), .solver = GetParam()};
  const Reduced reduced = reduce(family, kMaterials, options);
  EXPECT_EQ(reduced.modes.training().complete, GetParam() == ParametricSolver::sparse);
  EXPECT_EQ(reduced.modes.training().beyond, 0);
  expect_within_bounds(reduced, options, kMaterials, random_points());
}

TEST(ParametricModes, ReducesAFrameWithUnknownHeight) {
  const Box box = {{0.006, 0.016}};
  const StructureFamily family{
      .at =
          [](std::span<const double> x) {
            return Mesh(parametric::portal(200e9, 70e9, 7800.0, x[0])).discretisation();
          },
      .nominal = {0.01}};
  const ParametricModesOptions options{.modes = 5};
  expect_within_bounds(reduce(family, box, options), options, box, random_points() / 5);
}

TEST(ParametricModes, BoundsHoldForUnknownCompression) {
  const Box box = {{-150.0, -20.0}};
  const StructureFamily family{
      .at =
          [](std::span<const double> x) {
            return Mesh(parametric::portal(200e9, 70e9, 7800.0, 0.01, x[0])).discretisation();
          },
      .nominal = {-80.0}};
  const ParametricModesOptions options{.modes = 5};
  expect_within_bounds(reduce(family, box, options), options, box, random_points() / 5);
}

TEST_P(ParametricSolvers, AcceptsDegreesOfFreedomWithoutMass) {
  const Box box = {{-0.4, 0.4}, {-0.4, 0.4}, {-0.5, 2.0}};
  const StructureFamily family = parametric::family_of(parametric::floors(40));
  const ParametricModesOptions options{
      .modes = 6, .motions = some_motions(family.at(family.nominal), 10), .solver = GetParam()};
  expect_within_bounds(reduce(family, box, options), options, box, random_points());
}

TEST(ParametricModes, ExcludesTheRigidMotionOfAFreeChain) {
  const Box box = {{600.0, 1400.0}, {800.0, 1600.0}};
  const StructureFamily family = parametric::shear_chain(90, false);
  const ParametricModesOptions options{.modes = 5};
  expect_within_bounds(reduce(family, box, options), options, box, random_points());
}

TEST(ParametricModes, SmallStructuresAreNotReduced) {
  const Box box = {{100.0, 5000.0}, {100.0, 5000.0}};
  const StructureFamily family = parametric::shear_chain(6);
  const ParametricModesOptions options{.modes = 6,
                                       .motions = some_motions(family.at(family.nominal), 1)};
  const Reduced reduced = reduce(family, box, options);
  EXPECT_TRUE(reduced.modes.training().complete);
  expect_within_bounds(reduced, options, box, random_points());
}

// Two equal chains on one ground: every mode is double, and splits if their stiffnesses differ.
TEST_P(ParametricSolvers, CloseModesShareABound) {
  const Box box = {{900.0, 1100.0}, {999.0, 1001.0}};
  const StructureFamily family{
      .at =
          [](std::span<const double> x) {
            LumpedChain chain{.masses = std::vector<double>(80, 1.0), .links = {}};
            for (int i = 0; i < 80; ++i) {
              const bool first_of_chain = i == 0 || i == 40;
              chain.links.push_back({.name = "link",
                                     .between = {first_of_chain ? 0 : i, i + 1},
                                     .stiffness = i % 40 < 20 ? (i < 40 ? 1000.0 : x[1]) : x[0]});
            }
            return discretise(chain);
          },
      .nominal = {1000.0, 1000.0}};
  const ParametricModesOptions options{.modes = 6, .solver = GetParam()};
  expect_within_bounds(reduce(family, box, options), options, box, random_points() / 3);
}

// Far outside the training range the structure is solved in full, so the result is exact.
TEST(ParametricModes, SolvesInFullOutsideTheTrainingRange) {
  const ParametricModesOptions options{.modes = 6, .solver = ParametricSolver::basis};
  const Reduced reduced = reduce(parametric::portal_materials(), kMaterials, options);
  auto workspace = reduced.modes.make_workspace();
  ParametricModes::Modes found;
  const std::vector<double> far = {4e9, 900e9, 20000.0};
  reduced.modes.solve(far, workspace, found);
  EXPECT_TRUE(found.in_full);
  EXPECT_EQ(workspace.solved_in_full(), 1);
  const StructureModes full = structure_modes(reduced.structure->assemble(far), 6);
  for (Index i = 0; i < 6; ++i) EXPECT_NEAR(found.eigenvalues[i] / full.eigenvalues[i], 1.0, 1e-12);
}

TEST_P(ParametricSolvers, DerivativesEqualFiniteDifferences) {
  const StructureFamily family = parametric::portal_materials();
  const Discretisation d = family.at(family.nominal);
  const ParametricModesOptions options{
      .modes = 6, .motions = some_motions(d, 41), .solver = GetParam()};
  const Reduced reduced = reduce(family, kMaterials, options);
  auto workspace = reduced.modes.make_workspace();
  ParametricModes::Modes at, above, below;
  ParametricModes::Slopes slopes;
  const std::vector<double> theta = {190e9, 77e9, 7600.0};
  ASSERT_TRUE(reduced.modes.differentiate(theta, workspace, at, slopes));
  for (std::size_t j = 0; j < theta.size(); ++j) {
    auto up = theta, down = theta;
    const double step = 1e-4 * theta[j];
    up[j] += step, down[j] -= step;
    reduced.modes.solve(up, workspace, above);
    reduced.modes.solve(down, workspace, below);
    for (Index i = 0; i < 6; ++i) {
      const double slope = (above.eigenvalues[i] - below.eigenvalues[i]) / (2.0 * step);
      EXPECT_NEAR(slopes.eigenvalues(i, static_cast<Index>(j)), slope,
                  2e-5 * at.eigenvalues[i] / theta[j]);
      const auto aligned = [&](const VectorXd& shape) {
        return VectorXd(shape.dot(at.shapes.col(i)) < 0.0 ? -shape : shape);
      };
      const VectorXd by_differences =
          (aligned(above.shapes.col(i)) - aligned(below.shapes.col(i))) / (2.0 * step);
      EXPECT_LT((slopes.shapes[j].col(i) - by_differences).norm(),
                1e-3 * at.shapes.col(i).norm() / theta[j])
          << "mode " << i + 1 << ", parameter " << j;
    }
  }
}

// Regression: the derivatives had the signs of the reduced basis, the shapes those of the full
// solution.
TEST(ParametricModes, DerivativesHaveTheSignsOfAFullSolution) {
  const StructureFamily family = parametric::portal_materials();
  const Discretisation d = family.at(family.nominal);
  const ParametricModesOptions options{
      .modes = 6, .motions = some_motions(d, 41), .solver = ParametricSolver::basis};
  const Reduced reduced = reduce(family, kMaterials, options);
  auto workspace = reduced.modes.make_workspace();
  ParametricModes::Modes at, above;
  ParametricModes::Slopes slopes;
  for (const std::vector<double>& theta :
       {std::vector{5e10, 3e11, 7800.0}, std::vector{8e10, 2e11, 7800.0}}) {
    ASSERT_TRUE(reduced.modes.differentiate(theta, workspace, at, slopes));
    ASSERT_TRUE(at.in_full);
    auto up = theta;
    up[0] *= 1.001;
    reduced.modes.solve(up, workspace, above);
    for (Index i = 0; i < 6; ++i) {
      const VectorXd shape = at.shapes.col(i);
      const double sign = above.shapes.col(i).dot(shape) < 0.0 ? -1.0 : 1.0;
      const VectorXd change = sign * above.shapes.col(i) - shape;
      EXPECT_GT(change.dot(slopes.shapes[0].col(i)), 0.0) << "mode " << i + 1;
    }
  }
}

// Twin modes have no unique shapes, but derivatives of eigenvalues and of their common plane.
TEST_P(ParametricSolvers, DerivativesOfTwinModesAreFinite) {
  StructureFamily family{.at =
                             [](std::span<const double> x) {
                               LumpedChain chain{.masses = {1.0, 1.0}, .links = {}};
                               chain.links.push_back({"1", {0, 1}, x[0]});
                               chain.links.push_back({"2", {0, 2}, x[1]});
                               return discretise(chain);
                             },
                         .nominal = {100.0, 100.0}};
  const SparseRow first{.dofs = {0}, .coefficients = {1.0}},
      second{.dofs = {1}, .coefficients = {1.0}};
  const Reduced reduced = reduce(family, {{50.0, 150.0}, {50.0, 150.0}},
                                 {.modes = 2, .motions = {first, second}, .solver = GetParam()});
  auto workspace = reduced.modes.make_workspace();
  ParametricModes::Modes at;
  ParametricModes::Slopes slopes;
  ASSERT_TRUE(reduced.modes.differentiate(std::vector{100.0, 100.0}, workspace, at, slopes));
  EXPECT_NEAR(slopes.eigenvalues.col(0).sum(), 1.0, 1e-9);
  EXPECT_NEAR(slopes.eigenvalues.col(1).sum(), 1.0, 1e-9);
  for (const Eigen::MatrixXd& shapes : slopes.shapes) EXPECT_LT(shapes.norm(), 1e-6);
}

// In the second mode of a uniform chain between two walls, the parts beside the middle have the
// eigenvalue of the whole, so that a factor without pivoting has a pivot of zero within rounding.
TEST(ParametricModes, BothSolversAgreeOnDerivativesOfAUniformChain) {
  const StructureFamily family{
      .at =
          [](std::span<const double> x) {
            LumpedChain chain{.masses = std::vector<double>(39, 1.0), .links = {}};
            for (int i = 0; i < 40; ++i)
              chain.links.push_back(
                  {.name = "link", .between = {i, (i + 1) % 40}, .stiffness = x[i < 13 ? 0 : 1]});
            return discretise(chain);
          },
      .nominal = {100.0, 100.0}};
  std::vector<SparseRow> motions;
  for (int i = 0; i < 39; i += 3) motions.push_back({.dofs = {i}, .coefficients = {1.0}});
  std::vector<ParametricModes::Modes> modes(2);
  std::vector<ParametricModes::Slopes> slopes(2);
  for (const std::size_t s : {0, 1}) {
    const Reduced reduced =
        reduce(family, {{50.0, 150.0}, {50.0, 150.0}},
               {.modes = 4,
                .motions = motions,
                .solver = s == 0 ? ParametricSolver::basis : ParametricSolver::sparse});
    auto workspace = reduced.modes.make_workspace();
    ASSERT_TRUE(
        reduced.modes.differentiate(std::vector{100.0, 100.0}, workspace, modes[s], slopes[s]));
  }
  for (Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(modes[0].eigenvalues[i], modes[1].eigenvalues[i], 1e-9);
    const double sign = modes[0].shapes.col(i).dot(modes[1].shapes.col(i)) > 0.0 ? 1.0 : -1.0;
    for (const std::size_t j : {0, 1}) {
      const VectorXd theirs = slopes[0].shapes[j].col(i), ours = slopes[1].shapes[j].col(i);
      EXPECT_LT((sign * ours - theirs).norm(), 1e-6 * theirs.norm()) << "mode " << i + 1;
    }
  }
}

TEST(ParametricModes, RejectsMoreModesThanThereAre) {
  EXPECT_THROW(reduce(parametric::shear_chain(3), {{500.0, 1500.0}, {500.0, 1500.0}}, {.modes = 4}),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::fem
