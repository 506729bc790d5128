#include "fem/structures/structure_reanalysis.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "braced_portal.hpp"
#include "fem/structures/structure_defects.hpp"
#include "fem/structures/structure_modes.hpp"

namespace wheeltap::fem {
namespace {

StructureChange random_change(const Mesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  StructureChange change;
  std::vector<int> elements;
  for (int n = 1 + static_cast<int>(3.0 * uniform(random)); n > 0; --n) {
    const auto e = static_cast<int>(uniform(random) * static_cast<double>(mesh.elements().size()));
    if (std::ranges::find(elements, e) != elements.end()) continue;
    elements.push_back(e);
    const double left = std::pow(10.0, -3.0 * uniform(random));
    const auto& strains = mesh.elements()[static_cast<std::size_t>(e)].strains;
    if (uniform(random) < 0.5) {
      for (const int row : strains)
        if (row >= 0) change.softenings.push_back({{{row, 1.0}}, left});
    } else {  // as a crack: one combination of a moment and a shear force
      const double angle = uniform(random);
      change.softenings.push_back(
          {{{strains[static_cast<std::size_t>(ElementStrain::bending_z)], std::cos(angle)},
            {strains[static_cast<std::size_t>(ElementStrain::shear_z)], std::sin(angle)}},
           left});
    }
  }
  const auto place = [&] {
    const auto member = static_cast<int>(uniform(random) * 4.0);
    const auto direction = uniform(random) < 0.5 ? Direction::x : Direction::y;
    return mesh.motion(member, uniform(random) * mesh.member_length(member), direction);
  };
  if (uniform(random) < 0.4) {
    const int member = static_cast<int>(uniform(random) * 4.0);
    const double s = uniform(random) * mesh.member_length(member);
    // Gained, or a part of an element's own lost.
    const double mass = uniform(random) < 0.5 ? std::pow(10.0, -2.0 + 4.0 * uniform(random))
                                              : -2.0 * uniform(random);
    change.masses = change_of(mesh, {.masses = {{member, s, mass}}}).masses;
  }
  if (uniform(random) < 0.4)
    change.springs.push_back({place(), std::pow(10.0, 3.0 + 6.0 * uniform(random))});
  if (uniform(random) < 0.1)
    change.springs.push_back({place(), std::numeric_limits<double>::infinity()});
  return change;
}

/// Elastic frequencies [Hz] in long double, the strains' products unrounded.
std::vector<double> long_double_frequencies(const Discretisation& d, std::size_t count) {
  using Real = long double;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix k = Matrix::Zero(d.size(), d.size());
  for (const Strain& s : d.strains)
    for (std::size_t i = 0; i < s.row.dofs.size(); ++i)
      for (std::size_t j = 0; j < s.row.dofs.size(); ++j)
        k(s.row.dofs[i], s.row.dofs[j]) +=
            static_cast<Real>(s.factor) * s.row.coefficients[i] * s.row.coefficients[j];
  const Matrix m = Eigen::MatrixXd(d.mass).cast<Real>();
  // The lowest are the largest μ of M φ = μ (K + u M) φ.
  const Real unit = 1e3L;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(m, k + unit * m,
                                                                Eigen::EigenvaluesOnly);
  std::vector<double> out;
  const Eigen::Index n = d.size(), rigid = d.rigid_motions.cols();
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(count); ++i) {
    const Real lambda = 1 / solver.eigenvalues()[n - 1 - i] - unit;
    out.push_back(
        i < rigid ? 0.0 : static_cast<double>(std::sqrt(lambda) / (2 * std::numbers::pi_v<Real>)));
  }
  return out;
}

/// The changes of `random_change` leave down to a thousandth of an element, add a hundredth to a
/// hundred kilograms or take some away, and hold by soft and stiff springs.
struct Compared {
  double full = 0.0, with_mass = 0.0, wide = 0.0;  // worst relative errors
};
Compared compare(const Structure& s, int sets, int wide_sets, std::uint64_t seed) {
  const Mesh mesh(s);
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis reanalysis(d, 16);
  auto workspace = reanalysis.make_workspace();
  std::mt19937_64 random(seed);
  Compared worst;
  for (int trial = 0; trial < sets; ++trial) {
    const StructureChange change = random_change(mesh, random);
    std::vector<double> f(12);
    reanalysis.solve(change, workspace, {.frequencies_hz = f});
    const Discretisation after = changed(*d, change);
    const StructureModes full = structure_modes(after, 12);
    const std::vector<double> wide =
        trial < wide_sets ? long_double_frequencies(after, f.size()) : std::vector<double>();
    for (std::size_t i = 0; i < f.size(); ++i) {
      const double exact = full.frequencies_hz[static_cast<Eigen::Index>(i)];
      const double error = exact == 0.0 ? f[i] : std::abs(f[i] / exact - 1.0);
      if (!wide.empty() && wide[i] > 0.0 && change.masses.empty())
        worst.wide = std::max(worst.wide, std::abs(f[i] / wide[i] - 1.0));
      double& kind = change.masses.empty() ? worst.full : worst.with_mass;
      kind = std::max(kind, error);
      if (error > (change.masses.empty() ? 1e-9 : 2e-7))
        ADD_FAILURE() << "set " << trial << ", mode " << i << ": " << f[i] << " for " << exact;
    }
  }
  return worst;
}

TEST(StructureReanalysis, AgreesWithFullSolutions) {
  for (const int dimension : {2, 3})
    for (const bool free : {false, true}) {
      Structure s = braced_portal(dimension == 2 ? 6 : 3, dimension);
      if (free) s.supports.clear();
      const Compared worst = compare(s, 500, 75, 11);
      const std::string which = std::to_string(dimension) + (free ? " free" : " held");
      std::cout << which << ": worst " << worst.full << ", with masses " << worst.with_mass
                << "; of 75 in long double " << worst.wide << "\n";
      EXPECT_LT(worst.full, 1e-9) << which;
      EXPECT_LT(worst.wide, 1e-9) << which;
    }
}

/// Of `sets` random changes, frequencies by `kept` modes against full solutions.
void expect_bounds(const std::string& which, const Structure& s, int kept, int sets) {
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
    } catch (const ImpossibleChange&) {  // it buckles, as the full solution must say, too
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
  std::cout << which << ", " << kept << " of " << d->size() << ": above by at most " << above
            << ", below by " << below << "; widest bound " << widest << "\n";
}

/// With few of its modes kept, a structure's frequencies are within their bounds of the whole
/// one's, and below it only by rounding.
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
  // So few that many a bound is too wide, and the full solution takes its place.
  expect_bounds("hardly any", braced_portal(12, 2), 14, 60);
}

/// What is taken away is compared with the mass that is there, not with what few modes see of it.
TEST(StructureReanalysis, FewModesDoNotTakeMoreMassThanThereIs) {
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

TEST(StructureReanalysis, FewModesOfAnUnchangedStructureAreItsOwn) {
  const Mesh mesh(braced_portal(12, 2));
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis few(d, 6, 20);
  auto workspace = few.make_workspace();
  std::vector<double> f(6), bounds(6);
  // Nothing, a softening that leaves all, a spring at a clamped foot.
  const std::vector<StructureChange> changes = {
      {}, {.softenings = {{{{0, 1.0}}, 1.0}}}, {.springs = {{mesh.motion(0, Direction::x), 1e6}}}};
  for (const StructureChange& change : changes) {
    few.solve(change, workspace, {.frequencies_hz = f, .bounds_hz = bounds});
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(f[i] / few.intact_frequencies_hz()[i], 1.0, 1e-12);
  }
}

/// Near buckling, what is lost of the stiffness may leave less than its share of a frequency, and
/// beyond it nothing stands.
TEST(StructureReanalysis, CompressedMembersMayBuckle) {
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

/// Shapes of a changed portal beside those of its full solution, within `tolerance` of the largest
/// motion.
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

// An error of 1e-8 in λ is one of 1e-4 in the shape.
TEST(StructureReanalysis, FewModesGiveShapes) {
  expect_shapes(12, 40, 1e-4);
}

TEST(StructureReanalysis, RefusesWhatIsNoChange) {
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
