#include "fem/structures/defects/structure_defects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "base/constants.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"

namespace wheeltap::fem {
namespace {

/// A simply supported beam of 1 m, h/L = 0.1; `slender` without shear and rotary inertia.
Structure beam(int elements, bool slender) {
  const double h = 0.1, b = 0.05;
  const Material material{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  MemberSection section{.area = b * h, .second_moment_y = b * h * h * h / 12.0, .depth = h};
  if (!slender) section.shear_coefficient_z = 5.0 / 6.0;
  Structure s{.dimension = 2, .nodes = {{"A", {0, 0, 0}}, {"B", {1, 0, 0}}}, .members = {}};
  s.members.push_back({.name = "beam",
                       .nodes = {0, 1},
                       .elements = elements,
                       .pieces = {{.to = 1.0, .material = material, .section = section}}});
  s.supports = {{.node = 0, .fix = {true, true}}, {.node = 1, .fix = {false, true}}};
  s.rotary_inertia = !slender;
  return s;
}

double first_frequency(const Mesh& mesh, const StructureDefects& defects) {
  const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
  const StructureReanalysis reanalysis(d, 2);
  auto workspace = reanalysis.make_workspace();
  std::vector<double> f(1);
  reanalysis.solve(change_of(mesh, defects), workspace, {.frequencies_hz = f});
  return f[0];
}

/// Θ z (tan z - tanh z) = 2, z = βL/2 the smallest root, Θ = c EI/L: f₁/f₀ = (2z/π)².
TEST(StructureDefects, CrackAtMidspanMatchesTheClosedForm) {
  const double expected[] = {.989551, .961561, .917299, .854997, .771560};
  // At a node, and in the middle of an element.
  for (const int elements : {20, 21}) {
    const Mesh mesh(beam(elements, true));
    const double intact = first_frequency(mesh, {});
    for (int i = 0; i < 5; ++i) {
      const double depth = 0.1 * (i + 1);
      const double ratio =
          first_frequency(mesh, {.cracks = {{0, 0.5, depth, &crack_laws()[0]}}}) / intact;
      EXPECT_NEAR(ratio, expected[i], 1e-5) << depth << ", " << elements << " elements";
    }
  }
}

/// The other laws agree with the first for shallow to moderate cracks.
TEST(StructureDefects, CrackLawsAgreeForModerateDepths) {
  for (const double depth : {0.1, 0.3, 0.5}) {
    const double tada = crack_compliance(*find_crack_law("tada"), depth, 0.1, 1e4, 0.3);
    EXPECT_NEAR(crack_compliance(*find_crack_law("tada-plane-strain"), depth, 0.1, 1e4, 0.3),
                0.91 * tada, 1e-12 * tada);
    EXPECT_NEAR(crack_compliance(*find_crack_law("ostachowicz-krawczuk"), depth, 0.1, 1e4, 0.3),
                tada, 0.05 * tada)
        << depth;
  }
  EXPECT_THROW((void)crack_compliance(crack_laws()[0], 1.0, 0.1, 1e4, 0.3), std::invalid_argument);
  EXPECT_THROW((void)crack_compliance(crack_laws()[0], 0.1, 0.0, 1e4, 0.3), std::invalid_argument);
}

/// A hinge with the crack's compliance, made of two members with a sprung end, is the same
/// structure except for the inertia of the kink, which follows statically: an error of fourth
/// order.
TEST(StructureDefects, CrackEqualsASpringBetweenMembers) {
  const auto difference_at = [](int times) {
    const double at = 0.35;
    const Structure whole = beam(20 * times, false);
    const double ei = 210e9 * whole.members[0].pieces[0].section.second_moment_y;
    const double c = crack_compliance(crack_laws()[0], 0.4, 0.1, ei, 0.3);
    Structure split = whole;
    split.nodes.push_back({"crack", {at, 0, 0}});
    split.members[0].nodes = {0, 2};
    split.members[0].elements = 7 * times;
    split.members[0].pieces[0].to = at;
    split.members.push_back(split.members[0]);
    split.members[1].nodes = {2, 1};
    split.members[1].elements = 13 * times;
    split.members[1].pieces[0].to = 1.0 - at;
    split.members[0].ends[1].rotation.fill(1.0 / c);
    const double hinged = structure_modes(Mesh(split).discretisation(), 1).frequencies_hz[0];
    return first_frequency(Mesh(whole), {.cracks = {{0, at, 0.4, &crack_laws()[0]}}}) / hinged -
           1.0;
  };
  const double coarse = difference_at(1), fine = difference_at(2);
  EXPECT_LT(std::abs(coarse), 2e-7);
  EXPECT_GT(std::abs(coarse / fine), 10.0);
}

/// Reduced stiffness over a segment equals a member of pieces; overlapping reductions multiply;
/// over whole elements it equals reductions of the elements.
TEST(StructureDefects, ReductionOverASegmentEqualsAPiecewiseMember) {
  const Structure whole = beam(20, false);
  Structure pieces = whole;
  Member::Piece piece = whole.members[0].pieces[0];
  pieces.members[0].pieces.clear();
  for (const auto& [to, left] :
       {std::pair{0.31, 1.0}, {0.4, 0.7}, {0.52, 0.7 * 0.5}, {0.63, 0.5}, {1.0, 1.0}}) {
    piece.to = to;
    piece.material.young = left * 210e9;
    pieces.members[0].pieces.push_back(piece);
  }
  const double expected = structure_modes(Mesh(pieces).discretisation(), 1).frequencies_hz[0];
  const double found =
      first_frequency(Mesh(whole), {.reductions = {{0, 0.31, 0.52, 0.3}, {0, 0.4, 0.63, 0.5}}});
  // The mesh with pieces has more nodes: the strains are equal, but slightly more mass moves.
  EXPECT_NEAR(found, expected, 2e-6 * expected);
  const Mesh mesh(whole);
  const StructureChange change =
      change_of(mesh, {.reductions = {{0, 0.05, 0.1, 0.3}, {0, 0.05, 0.1, 0.5}}});
  ASSERT_EQ(change.softenings.size(), 3u);
  for (const auto& s : change.softenings) EXPECT_NEAR(s.remaining, 0.35, 1e-14);
}

/// Timoshenko beam with a mass m at mid-span, in the slender limit: its secular equation
/// (tan z - tanh z) μ z = 2, μ = m / ρAL, z = βL/2, f = f₀ (2z/π)².
TEST(StructureDefects, AddedMassAtMidspanMatchesTheClosedForm) {
  const Structure s = beam(40, true);
  const Mesh mesh(s);
  const double line = 7850.0 * s.members[0].pieces[0].section.area;
  const double intact = first_frequency(mesh, {});
  for (const double mu : {1e-6, 0.01, 0.3, 5.0}) {
    double low = 1e-3, high = kPi / 2 * (1.0 - 1e-15);
    for (int i = 0; i < 200; ++i) {
      const double z = 0.5 * (low + high);
      (mu * z * (std::tan(z) - std::tanh(z)) < 2.0 ? low : high) = z;
    }
    const double expected = intact * std::pow(2.0 * low / kPi, 2);
    EXPECT_NEAR(first_frequency(mesh, {.masses = {{0, 0.5, mu * line}}}), expected, 2e-6 * expected)
        << mu;
  }
}

TEST(StructureDefects, LooseJointEqualsASofterSpring) {
  Structure s = beam(20, false);
  s.supports[0].stiffness[5] = 1e5;
  const double loose = first_frequency(Mesh(s), {.joints = {{0, 0.6}}});
  s.supports[0].stiffness[5] = 4e4;
  const double softer = first_frequency(Mesh(s), {});
  EXPECT_NEAR(loose, softer, 1e-10 * softer);
  // A clamp whose fixity is 1 - r.
  s.supports[0].stiffness[5] = 0.0;
  s.supports[0].fix[5] = true;
  const double ei = 210e9 * s.members[0].pieces[0].section.second_moment_y;
  const double fixity = first_frequency(Mesh(s), {.joints = {{0, 0.25}}});
  s.supports[0].fix[5] = false;
  s.supports[0].stiffness[5] = 3.0 * ei * 0.75 / 0.25;
  EXPECT_NEAR(fixity, first_frequency(Mesh(s), {}), 1e-6 * fixity);
}

}  // namespace
}  // namespace wheeltap::fem
