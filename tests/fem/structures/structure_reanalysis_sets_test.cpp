// Compares reanalysis with full solutions, and with those in long double, for random sets of every
// kind of defect on every kind of structure. Short: 200 sets per structure, 20 of them in long
// double. WHEELTAP_LONG_TESTS=1: 2000 and 300.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <numbers>
#include <random>

#include "base/eigen_solvers.hpp"
#include "braced_portal.hpp"
#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "random_changes.hpp"

namespace wheeltap::fem::structure_reanalysis_sets_test {
namespace {

constexpr std::size_t kModes = 12;
/// The stated relative accuracy of frequencies if all modes are kept.
constexpr double kStated = 1e-9;
/// Accuracy of shapes: an error of 1e-12 in λ gives a contribution of 1e-6 from a neighbouring
/// mode.
constexpr double kShapes = 1e-5;

/// Elastic frequencies [Hz] in long double, with unrounded products of the strains.
std::vector<double> long_double_frequencies(const Discretisation& d, std::size_t count) {
  using Real = long double;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix k = Matrix::Zero(d.size(), d.size());
  if (d.rest.rows() > 0) k = Eigen::MatrixXd(d.rest).cast<Real>();
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

/// Errors of the shapes at some motions, relative to the full solution there, if modes are at least
/// a thousandth apart.
double shape_error(const StructureModes& full, const std::vector<SparseRow>& motions,
                   const std::vector<double>& shapes) {
  const auto n = static_cast<Eigen::Index>(motions.size());
  double worst = 0.0;
  for (Eigen::Index i = full.rigid_body_modes; i + 1 < full.eigenvalues.size(); ++i) {
    const auto apart = [&](Eigen::Index j) {
      return std::abs(full.eigenvalues[j] / full.eigenvalues[i] - 1.0) > 1e-3;
    };
    if (!apart(i + 1) || (i > 0 && !apart(i - 1))) continue;
    const Eigen::Map<const Eigen::VectorXd> ours(shapes.data() + i * n, n);
    Eigen::VectorXd truth(n);
    for (Eigen::Index m = 0; m < n; ++m)
      truth[m] = motions[static_cast<std::size_t>(m)].of(full.shapes.col(i));
    worst = std::max(worst, std::min((ours - truth).norm(), (ours + truth).norm()) / truth.norm());
  }
  return worst;
}

using Draw = std::function<StructureChange(std::mt19937_64&)>;

/// Draws sets, and compares every frequency with the full solution and its stated bound.
void expect_agreement(const std::string& which, const Discretisation& given, const Draw& draw) {
  const bool full_numbers = std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
  const int sets = full_numbers ? 2000 : 200, wide_sets = full_numbers ? 300 : 20;
  const auto d = std::make_shared<const Discretisation>(given);
  const StructureReanalysis reanalysis(d, static_cast<int>(kModes) + 4);
  auto workspace = reanalysis.make_workspace();
  std::mt19937_64 random(11);
  std::vector<SparseRow> motions;
  for (int dof = 0; dof < static_cast<int>(d->size()); dof += 5) motions.push_back({{dof}, {1.0}});
  double worst = 0.0, worst_wide = 0.0, worst_shape = 0.0;
  int impossible = 0, wide_solved = 0;
  for (int set = 0; set < sets; ++set) {
    const StructureChange change = draw(random);
    std::vector<double> f(kModes), bounds(kModes), shapes(kModes * motions.size());
    try {
      reanalysis.solve(
          change, workspace,
          {.frequencies_hz = f, .shapes = shapes, .motions = motions, .bounds_hz = bounds});
    } catch (const ImpossibleChange&) {  // the full solution must throw as well
      EXPECT_ANY_THROW((void)structure_modes(changed(*d, change), static_cast<int>(kModes)))
          << which << ", set " << set;
      ++impossible;
      continue;
    }
    std::vector<SparseRow> left = motions;
    const Discretisation after = changed(*d, change, left);
    const StructureModes full = structure_modes(after, static_cast<int>(kModes));
    const double shape = shape_error(full, left, shapes);
    EXPECT_LT(shape, kShapes) << which << ", set " << set;
    worst_shape = std::max(worst_shape, shape);
    const bool wide = wide_solved < wide_sets;
    wide_solved += wide;
    const std::vector<double> widely =
        wide ? long_double_frequencies(after, kModes) : std::vector<double>();
    for (std::size_t i = 0; i < kModes; ++i) {
      const double exact = full.frequencies_hz[static_cast<Eigen::Index>(i)];
      EXPECT_LE(bounds[i], kStated * f[i]);
      if (exact == 0.0) {
        EXPECT_EQ(f[i], 0.0) << which << ", set " << set << ", mode " << i;
        continue;
      }
      worst = std::max(worst, std::abs(f[i] / exact - 1.0));
      EXPECT_NEAR(f[i], exact, bounds[i]) << which << ", set " << set << ", mode " << i;
      if (!wide) continue;
      worst_wide = std::max(worst_wide, std::abs(f[i] / widely[i] - 1.0));
      EXPECT_NEAR(f[i], widely[i], bounds[i]) << which << ", set " << set << ", mode " << i;
    }
  }
  EXPECT_LT(impossible, sets / 4) << which;
  std::cout << which << ", " << d->size() << " degrees of freedom: " << sets - impossible
            << " sets, worst " << worst << ", of shapes " << worst_shape << "; of " << wide_solved
            << " in long double " << worst_wide << "\n";
}

/// Low-rank terms directly.
void expect_terms(const std::string& which, const Structure& s) {
  const Mesh mesh(s);
  expect_agreement(which, mesh.discretisation(),
                   [&](auto& random) { return random_change(mesh, random); });
}
/// Terms from defects of all kinds.
void expect_defects(const std::string& which, const Structure& s) {
  const Mesh mesh(s);
  expect_agreement(which, mesh.discretisation(),
                   [&](auto& random) { return change_of(mesh, random_defects(mesh, random)); });
}

Structure portal(int dimension, bool free) {
  Structure s = braced_portal(dimension == 2 ? 6 : 3, dimension);
  if (free) s.supports.clear();
  return s;
}

TEST(ReanalysisSets, TermsOfPortals) {
  for (const int dimension : {2, 3})
    for (const bool free : {false, true})
      expect_terms(std::to_string(dimension) + "-d portal, " + (free ? "free" : "held"),
                   portal(dimension, free));
}

TEST(ReanalysisSets, DefectsOfPortals) {
  for (const int dimension : {2, 3})
    for (const bool free : {false, true})
      expect_defects(
          "defects of a " + std::to_string(dimension) + "-d portal, " + (free ? "free" : "held"),
          portal(dimension, free));
}

/// Hinges, offsets, two materials in a member, a foundation, springs and point masses.
TEST(ReanalysisSets, DefectsOfAFrameWithAllFeatures) {
  for (const int dimension : {2, 3}) {
    Structure s = portal(dimension, false);
    s.members[0].pieces.insert(s.members[0].pieces.begin(), s.members[0].pieces[0]);
    s.members[0].pieces[0].to = 1.3;
    s.members[0].pieces[0].material = {.young = 70e9, .poisson = 0.33, .density = 2700.0};
    s.members[1].foundation = 2e4;
    s.members[2].ends[0].offset = {-0.1, 0.05, 0.0};
    s.members[2].pieces[0].to = member_frame(s, 2).length;
    s.members[3].ends[1].rotation[1] = 0.0;
    s.members[2].axial_force = 2e5;
    s.masses.push_back({.node = 2, .mass = 80.0, .inertia = {2.0, 3.0, 4.0}});
    s.springs.push_back({.nodes = {1, NodeSpring::kGround},
                         .direction = static_cast<int>(Direction::x),
                         .stiffness = 3e5});
    expect_defects("a " + std::to_string(dimension) + "-d frame with everything", s);
  }
}

TEST(ReanalysisSets, DefectsOfACompressedFrame) {
  Structure s = portal(2, false);
  s.members[0].axial_force = -3e5;
  expect_defects("a compressed frame", s);
}

/// Rotations without mass.
TEST(ReanalysisSets, DefectsOfAFrameOfLumpedMasses) {
  for (const bool free : {false, true}) {
    Structure s = portal(2, free);
    s.mass = Structure::Mass::lumped;
    s.rotary_inertia = false;
    expect_defects(std::string("a frame of lumped masses, ") + (free ? "free" : "held"), s);
  }
}

/// Only its nodes have mass.
TEST(ReanalysisSets, DefectsOfAStickOfPointMasses) {
  for (const bool free : {false, true}) {
    Structure s{.dimension = 2, .nodes = {}, .members = {}};
    const Material weightless{.young = 30e9, .poisson = 0.2, .density = 0.0};
    const MemberSection section{
        .area = 0.4, .second_moment_y = 0.02, .shear_coefficient_z = 0.8, .depth = 0.8};
    for (int storey = 0; storey <= 9; ++storey) {
      s.nodes.push_back({"n" + std::to_string(storey), {0.0, 3.0 * storey, 0.0}});
      if (storey == 0 && !free) continue;
      s.masses.push_back({.node = storey, .mass = 300.0 + 20.0 * storey});
    }
    for (int storey = 0; storey < 9; ++storey)
      s.members.push_back({.name = "m" + std::to_string(storey),
                           .nodes = {storey, storey + 1},
                           .elements = 3,
                           .pieces = {{.to = 3.0, .material = weightless, .section = section}}});
    if (!free) s.supports = {{.node = 0, .fix = {true, true, true, true, true, true}}};
    expect_defects(std::string("a stick of point masses, ") + (free ? "free" : "held"), s);
  }
}

/// Storeys with as little as a thousandth of their stiffness, masses more or less, springs to
/// ground.
TEST(ReanalysisSets, Chains) {
  for (const bool free : {false, true}) {
    LumpedChain chain;
    for (int i = free ? 1 : 0; i < 24; ++i)
      chain.links.push_back({"link", {i, i + 1}, 2e6 * (1.0 + 0.03 * i)});
    for (int i = 0; i < 24; ++i) chain.masses.push_back(100.0 + 7.0 * i);
    const Discretisation d = discretise(chain);
    expect_agreement(free ? "a free chain" : "a chain", d, [&](std::mt19937_64& random) {
      std::uniform_real_distribution<double> uniform(0.0, 1.0);
      const auto pick = [&](std::size_t size) {
        return static_cast<int>(uniform(random) * static_cast<double>(size));
      };
      StructureChange change;
      for (int n = 1 + pick(3); n > 0; --n)
        change.softenings.push_back(
            {{{pick(d.strains.size()), 1.0}}, std::pow(10.0, -3.0 * uniform(random))});
      compound(change);
      if (uniform(random) < 0.5)
        change.masses.push_back(
            {{{pick(24)}, {1.0}},
             uniform(random) < 0.5 ? 300.0 * uniform(random) : -90.0 * uniform(random)});
      if (uniform(random) < 0.4)
        change.springs.push_back(
            {{{pick(24)}, {1.0}}, std::pow(10.0, 3.0 + 6.0 * uniform(random))});
      return change;
    });
  }
}

/// Matrices of another program have no members: masses and springs at degrees of freedom.
TEST(ReanalysisSets, MatricesOfAnotherProgram) {
  Discretisation d = Mesh(portal(3, false)).discretisation();
  d.rest = d.stiffness;
  d.strains.clear();
  const auto n = static_cast<double>(d.size());
  expect_agreement("matrices", d, [&](std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    StructureChange change;
    const auto dof = [&] { return SparseRow{{static_cast<int>(uniform(random) * n)}, {1.0}}; };
    for (int i = static_cast<int>(3.0 * uniform(random)); i > 0; --i)
      change.masses.push_back({dof(), std::pow(10.0, -2.0 + 3.0 * uniform(random))});
    if (uniform(random) < 0.5) change.masses.push_back({dof(), -0.05 * uniform(random)});
    if (uniform(random) < 0.5)
      change.springs.push_back({dof(), std::pow(10.0, 3.0 + 6.0 * uniform(random))});
    return change;
  });
}

}  // namespace
}  // namespace wheeltap::fem::structure_reanalysis_sets_test
