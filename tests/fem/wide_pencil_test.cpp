#include "fem/beam/wide_pencil.hpp"

#include <gtest/gtest.h>

#include "beams.hpp"
#include "fem/beam/modal_analysis.hpp"

namespace wheeltap::fem {
namespace {

TEST(WidePencil, SeparatesNeighbouringEigenvalues) {
  const Beam beam = slender_beam("free-free", 150);
  WidePencil pencil(beam, {});
  const Eigen::VectorXd all = modal_analysis(beam, {}, {.modes = 14}).eigenvalues;
  for (int i = 2; i < 14; ++i) {
    EXPECT_TRUE(pencil.holds(i, all[i], 1e-12)) << i;
    EXPECT_FALSE(pencil.holds(i - 1, all[i], 1e-12)) << i;
    EXPECT_FALSE(pencil.holds(i + 1, all[i], 1e-12)) << i;
    EXPECT_FALSE(pencil.holds(i, all[i] * (1.0 + 3e-12), 1e-12)) << i;
    EXPECT_FALSE(pencil.holds(i, all[i] * (1.0 - 3e-12), 1e-12)) << i;
  }
}

TEST(WidePencil, ConfirmsBothOfAnEqualPair) {
  Beam beam = slender_beam("clamped-clamped", 20);
  beam.supports.push_back({.at = 0.5, .rotation = true, .stiffness = {}});  // pairs of equal modes
  WidePencil pencil(beam, {});
  const Modes modes = modal_analysis(beam, {}, {.modes = 5});  // one mode of a pair is included
  EXPECT_TRUE(modes.certified);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(pencil.holds(i, modes.eigenvalues[i], 1e-12)) << i;
}

TEST(WidePencil, RefinesARoughShape) {
  const Beam beam = slender_beam("cantilever", 60);
  WidePencil pencil(beam, {});
  WidePencil::Vector q(pencil.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {  // w = x², similar to the first mode
    const double x = static_cast<double>(i / 2 + 1) / 60.0;
    q[i] = i % 2 == 0 ? x * x : 2.0 * x;
  }
  const auto lambda = pencil.refine(q);
  ASSERT_TRUE(lambda.has_value());
  EXPECT_TRUE(pencil.holds(0, *lambda, 1e-15));
}

TEST(WidePencil, RigidMotionsAreExact) {
  for (const bool turning : {false, true}) {
    Beam beam = slender_beam("free-free", 9);
    beam.supports = {{.at = 0.29, .deflection = turning, .rotation = !turning, .stiffness = {}}};
    WidePencil pencil(beam, {});
    ASSERT_EQ(pencil.rigid_modes().size(), 1u);
    const auto u = pencil.all_dofs(pencil.rigid_modes()[0]);
    const StrainEnergy<DoubleDouble> energy(beam, {});
    EXPECT_LT(energy.twice(u), DoubleDouble(1e-40));
  }
}

}  // namespace
}  // namespace wheeltap::fem
