#include "fem/structures/reanalysis/structure_reanalysis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <random>

#include "base/eigen_solvers.hpp"
#include "braced_portal.hpp"
#include "fem/structures/defects/structure_defects.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "random_changes.hpp"

namespace wheeltap::fem {
namespace {

/// Compares frequencies with `kept` modes with full solutions for `sets` random changes (ten times
/// as many with WHEELTAP_LONG_TESTS=1).
void expect_bounds(const std::string& which, const Structure& s, int kept, int sets) {
  if (std::getenv("WHEELTAP_LONG_TESTS") != nullptr) sets *= 10;
  const Mesh mesh(s);
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis few(d, 12, kept);
  auto workspace = few.make_workspace();
  std::mt19937_64 random(7);
  double above = 0.0, below = 0.0, widest = 0.0;
  int solved = 0;
  for (int trial = 0; trial < sets; ++trial) {
    const StructureChange change = random_change(mesh, random);
    std::vector<double> f(12), bounds(12);
    try {
      few.solve(change, workspace, {.frequencies_hz = f, .bounds_hz = bounds});
    } catch (const ImpossibleChange&) {  // it buckles; the full solution must throw as well
      EXPECT_ANY_THROW((void)structure_modes(changed(*d, change), 12)) << which << ", " << trial;
      continue;
    }
    ++solved;
    const StructureModes full = structure_modes(changed(*d, change), 12);
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double exact = full.frequencies_hz[static_cast<Eigen::Index>(i)];
      if (exact == 0.0) {
        EXPECT_EQ(f[i], 0.0);
        continue;
      }
      above = std::max(above, f[i] / exact - 1.0);
      below = std::max(below, 1.0 - f[i] / exact);
      widest = std::max(widest, bounds[i] / exact);
      EXPECT_NEAR(f[i], exact, bounds[i]) << which << ", set " << trial << ", mode " << i;
    }
  }
  EXPECT_GT(solved, sets / 2) << which;
  std::cout << which << ", " << kept << " of " << d->size() << ": " << solved
            << " sets, above by at most " << above << ", below by " << below << "; widest bound "
            << widest << "\n";
}

/// With few kept modes, frequencies are within their bounds of those of the whole structure, and
/// below them only by rounding.
TEST(StructureReanalysis, FewModesBoundTheFrequencies) {
  for (const int dimension : {2, 3})
    for (const bool free : {false, true}) {
      Structure s = braced_portal(dimension == 2 ? 12 : 6, dimension);
      if (free) s.supports.clear();
      expect_bounds(std::to_string(dimension) + (free ? " free" : " held"), s, 40, 200);
    }
  Structure compressed = braced_portal(12, 2);
  compressed.members[0].axial_force = -1e6;
  expect_bounds("compressed", compressed, 40, 100);
  Structure lumped = braced_portal(12, 2);
  lumped.mass = Structure::Mass::lumped;
  expect_bounds("lumped masses", lumped, 40, 500);  // the full solution was wrong in its set 475
  // So few that many bounds are too wide, and the structure is solved in full.
  expect_bounds("hardly any", braced_portal(12, 2), 14, 60);
}

/// Removed mass is compared with the mass of the structure, not with that in the kept modes.
TEST(StructureReanalysis, RejectsRemovingMoreMassThanThereIs) {
  const Mesh mesh(braced_portal(12, 2));
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis few(d, 6, 20), all(d, 6);
  auto few_workspace = few.make_workspace(), all_workspace = all.make_workspace();
  std::vector<double> f(6);
  int refused = 0;
  for (double mass = 1.0; mass < 100.0; mass *= 1.2) {
    const StructureChange change = {.masses = {{mesh.motion(1, 2.0, Direction::y), -mass}}};
    const auto refuses = [&](const StructureReanalysis& by, auto& workspace) {
      try {
        by.solve(change, workspace, {.frequencies_hz = f});
      } catch (const ImpossibleChange&) {
        return true;
      }
      return false;
    };
    const bool wrong = refuses(all, all_workspace);
    refused += wrong;
    EXPECT_EQ(refuses(few, few_workspace), wrong) << mass << " kg";
  }
  EXPECT_GT(refused, 0);
}

TEST(StructureReanalysis, UnchangedStructureKeepsItsModes) {
  const Mesh mesh(braced_portal(12, 2));
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis few(d, 6, 20);
  auto workspace = few.make_workspace();
  std::vector<double> f(6), bounds(6);
  // No change, a softening with full stiffness, a spring at a clamped foot.
  const std::vector<StructureChange> changes = {
      {}, {.softenings = {{{{0, 1.0}}, 1.0}}}, {.springs = {{mesh.motion(0, Direction::x), 1e6}}}};
  for (const StructureChange& change : changes) {
    few.solve(change, workspace, {.frequencies_hz = f, .bounds_hz = bounds});
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(f[i] / few.intact_frequencies_hz()[i], 1.0, 1e-12);
  }
}

/// Near buckling, lost stiffness may reduce a frequency by more than its share; beyond buckling
/// there is no solution.
TEST(StructureReanalysis, DetectsBucklingOfCompressedMembers) {
  Structure s = braced_portal(6, 2);
  double critical = 0.0;
  for (double low = 0.0, high = 1e9; high - low > 1e-3 * high;) {
    const double force = 0.5 * (low + high);
    s.members[0].axial_force = -force;
    try {
      static_cast<void>(structure_modes(Mesh(s).discretisation(), 1));
      low = force;
    } catch (const InvalidStructure&) {
      high = force;
    }
    critical = low;
  }
  s.members[0].axial_force = -0.9 * critical;
  const Mesh mesh(s);
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis reanalysis(d, 8);
  auto workspace = reanalysis.make_workspace();
  int fell_further = 0, buckled = 0;
  for (const double remaining : {0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.3, 0.1})
    for (const int element : {0, 2, 4}) {
      StructureChange change;
      for (const int row : mesh.elements()[static_cast<std::size_t>(element)].strains)
        if (row >= 0) change.softenings.push_back({{{row, 1.0}}, remaining});
      std::vector<double> f(6);
      StructureModes full;
      try {
        full = structure_modes(changed(*d, change), 6);
      } catch (const InvalidStructure&) {
        ++buckled;
        EXPECT_THROW(reanalysis.solve(change, workspace, {.frequencies_hz = f}), ImpossibleChange);
        continue;
      }
      reanalysis.solve(change, workspace, {.frequencies_hz = f});
      for (std::size_t i = 0; i < f.size(); ++i) {
        const double exact = full.frequencies_hz[static_cast<Eigen::Index>(i)];
        EXPECT_NEAR(f[i] / exact, 1.0, 1e-8) << remaining << " of element " << element;
      }
      const double intact = reanalysis.intact_frequencies_hz()[0];
      fell_further += f[0] * f[0] < remaining * intact * intact;
    }
  EXPECT_GT(fell_further, 0);
  EXPECT_GT(buckled, 0);
}

/// Compares shapes of a changed portal with those of its full solution, within `tolerance` of the
/// largest motion.
void expect_shapes(int elements, int kept, double tolerance) {
  const Mesh mesh(braced_portal(elements, 2));
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis reanalysis(d, 8, kept);
  auto workspace = reanalysis.make_workspace();
  const StructureChange change =
      change_of(mesh, {.cracks = {{1, 2.0, 0.5, &crack_laws()[0]}}, .masses = {{2, 1.0, 20.0}}});
  const std::vector<SparseRow> motions = {mesh.motion(1, 2.2, Direction::y),
                                          mesh.motion(2, 1.0, Direction::x),
                                          mesh.motion(0, 1.5, Direction::x)};
  std::vector<double> f(6), shapes(6 * motions.size());
  reanalysis.solve(change, workspace, {.frequencies_hz = f, .shapes = shapes, .motions = motions});
  const StructureModes full = structure_modes(changed(*d, change), 6);
  for (std::size_t i = 0; i < f.size(); ++i) {
    double sign = 0.0;
    for (std::size_t m = 0; m < motions.size(); ++m) {
      const double expected = motions[m].of(full.shapes.col(static_cast<Eigen::Index>(i)));
      const double found = shapes[i * motions.size() + m];
      if (sign == 0.0) sign = expected * found > 0.0 ? 1.0 : -1.0;
      EXPECT_NEAR(sign * found, expected, tolerance * full.shapes.cwiseAbs().maxCoeff()) << i << m;
    }
  }
}

TEST(StructureReanalysis, ShapesAreThoseOfTheChangedStructure) {
  expect_shapes(6, 0, 1e-6);
}

// An error of 1e-8 in λ gives one of 1e-4 in the shape.
TEST(StructureReanalysis, FewModesGiveAccurateShapes) {
  expect_shapes(12, 40, 1e-4);
}

TEST(StructureReanalysis, RejectsInvalidChanges) {
  const Mesh mesh(braced_portal(2, 2));
  const StructureReanalysis reanalysis(
      std::make_shared<const Discretisation>(mesh.discretisation()), 4);
  auto workspace = reanalysis.make_workspace();
  std::vector<double> f(4);
  const auto solve = [&](StructureChange change) {
    reanalysis.solve(change, workspace, {.frequencies_hz = f});
  };
  EXPECT_THROW(solve({.softenings = {{{{0, 1.0}}, 0.0}}}), std::invalid_argument);
  EXPECT_THROW(solve({.softenings = {{{{100000, 1.0}}, 0.5}}}), std::invalid_argument);
  EXPECT_THROW(solve({.springs = {{mesh.motion(1, Direction::x), -1.0}}}), std::invalid_argument);
  EXPECT_THROW(solve({.masses = {{mesh.motion(1, Direction::x), -1e6}}}), ImpossibleChange);
}

}  // namespace
}  // namespace wheeltap::fem
