#include "fem/structures/reanalysis/scaled_structure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "fem/structures/modes/structure_modes.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "tests/fem/structures/braced_portal.hpp"
#include "tests/fem/structures/parametric_structures.hpp"
#include "tests/fem/structures/random_changes.hpp"

namespace wheeltap::fem {
namespace {

/// The portal with unknown Young's modulus, stiffness of a joint, density and point mass.
Structure frame(std::span<const double> theta) {
  Structure s = braced_portal(5, 2);
  for (Member& member : s.members) {
    member.pieces[0].material.young = theta[0];
    member.pieces[0].material.density = theta[2];
  }
  s.members[1].ends[0].rotation.fill(theta[1]);
  s.masses.push_back({.node = 2, .mass = theta[3]});
  return s;
}

StructureFamily frames() {
  return {.at = [](std::span<const double> x) { return Mesh(frame(x)).discretisation(); },
          .nominal = {210e9, 3e6, 7850.0, 50.0}};
}

const std::vector<std::array<double, 2>> kBox = {
    {150e9, 260e9}, {1e5, 5e7}, {6000.0, 9000.0}, {10.0, 200.0}};

// Frequencies and shapes at any parameters and with any defects equal those of full solutions.
// Cracks and loose joints change the mass by a share of the density, which a change of the base
// structure cannot distinguish from other added masses. The density is known there.
TEST(ScaledStructure, ReanalysisOfTheBaseSolvesAnyParameters) {
  const auto samples = parametric::draws(kBox, 30, 1);
  const auto scaled = ScaledStructure::of(frames(), samples);
  ASSERT_TRUE(scaled);
  EXPECT_EQ(scaled->columns(), 3);  // a strain of the joint, and two directions of the mass
  const Mesh mesh(frame(scaled->base_parameters()));
  constexpr std::size_t kCompared = 6;
  const StructureReanalysis reanalysis(scaled->base(), kCompared);
  auto workspace = reanalysis.make_workspace();
  const std::vector<SparseRow> motions = {mesh.motion(1, 1.3, Direction::y),
                                          mesh.motion(0, 2.0, Direction::x)};
  std::mt19937_64 random(3);
  double worst = 0.0, worst_shape = 0.0;
  int compared = 0;
  for (std::vector<double>& theta : parametric::draws(kBox, 60, 2)) {
    StructureDefects defects = random_defects(mesh, random);
    if (!defects.cracks.empty() || !defects.joints.empty()) theta[2] = scaled->base_parameters()[2];
    defects.masses.clear();  // removed mass is impossible for some of them
    const Mesh here(frame(theta));
    std::vector<SparseRow> there = motions;
    const Discretisation d = changed(here.discretisation(), change_of(here, defects), there);
    const StructureModes full = structure_modes(d, kCompared);
    StructureChange change = change_of(mesh, defects);
    const auto scales = scaled->scales(theta);
    ASSERT_TRUE(scales);
    const auto outcome = scaled->transform(theta, *scales, change);
    if (outcome == ScaledStructure::Outcome::unsupported) continue;
    ASSERT_EQ(outcome, ScaledStructure::Outcome::possible);
    std::vector<double> f(kCompared), shapes(kCompared * motions.size());
    reanalysis.solve(change, workspace,
                     {.frequencies_hz = f, .shapes = shapes, .motions = motions});
    ++compared;
    for (std::size_t i = 0; i < kCompared; ++i) {
      const double own = f[i] * std::sqrt(scales->stiffness / scales->mass);
      const double exact = full.frequencies_hz[static_cast<Eigen::Index>(i)];
      worst = std::max(worst, std::abs(own / exact - 1.0));
      Eigen::Vector2d a, b;
      for (std::size_t m = 0; m < motions.size(); ++m) {
        a[static_cast<Eigen::Index>(m)] = shapes[i * motions.size() + m] / std::sqrt(scales->mass);
        b[static_cast<Eigen::Index>(m)] =
            there[m].of(full.shapes.col(static_cast<Eigen::Index>(i)));
      }
      worst_shape = std::max(worst_shape, std::min((a - b).norm(), (a + b).norm()) / b.norm());
    }
  }
  EXPECT_GT(compared, 50);
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(worst_shape, 1e-5);
}

TEST(ScaledStructure, ScalesAloneNeedNoColumns) {
  StructureFamily family = frames();
  family.nominal = {210e9, 7850.0};
  family.at = [](std::span<const double> x) {
    Structure s = frame(std::vector<double>{x[0], 3e6, x[1], 0.0});
    s.members[1].ends = {};
    s.masses.clear();
    return Mesh(s).discretisation();
  };
  const auto scaled =
      ScaledStructure::of(family, parametric::draws({{150e9, 260e9}, {6000.0, 9000.0}}, 20, 1));
  ASSERT_TRUE(scaled);
  EXPECT_EQ(scaled->columns(), 0);
  const std::vector<double> theta = {180e9, 8000.0};
  EXPECT_NEAR(scaled->scales(theta)->stiffness, 180.0 / 210.0, 1e-12);
  EXPECT_NEAR(scaled->scales(theta)->mass, 8000.0 / 7850.0, 1e-12);
  EXPECT_FALSE(scaled->scales(std::vector<double>{-1.0, 8000.0}));
}

// Two materials are two scales, and axial forces do not scale with Young's modulus.
TEST(ScaledStructure, RejectsOtherForms) {
  const auto materials = parametric::portal_materials();
  EXPECT_FALSE(ScaledStructure::of(
      materials, parametric::draws({{150e9, 250e9}, {50e9, 90e9}, {7000.0, 9000.0}}, 20, 1)));
  StructureFamily compressed{
      .at =
          [](std::span<const double> x) {
            return Mesh(parametric::portal(x[0], x[0], 7800.0, 0.01, -10.0)).discretisation();
          },
      .nominal = {200e9}};
  EXPECT_FALSE(ScaledStructure::of(compressed, parametric::draws({{150e9, 250e9}}, 20, 1)));
}

}  // namespace
}  // namespace wheeltap::fem
