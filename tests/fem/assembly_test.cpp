#include "fem/beam/assembly.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "base/eigen_solvers.hpp"
#include "beams.hpp"
#include "refusal.hpp"

namespace wheeltap::fem {
namespace {

TEST(Assembly, DamagesInOneElementMultiply) {
  const Beam beam = slender_beam();
  const Eigen::VectorXd left = remaining_stiffness<double>(
      beam, {.damages = {{0.571, 0.5}, {0.09, 0.3}, {0.579, 0.2}}, .supports = {}});
  EXPECT_DOUBLE_EQ(left[57], 0.5 * 0.8);
  EXPECT_DOUBLE_EQ(left[9], 0.7);
  EXPECT_DOUBLE_EQ(left.sum(), 100.0 - 0.9);
}

TEST(Assembly, TotalMassEqualsThatOfTheBeam) {
  const Beam beam = slender_beam("free-free", 7);
  const Assembly<double> a = assemble<double>(beam, {});
  Eigen::VectorXd translation = Eigen::VectorXd::Zero(16);
  for (int i = 0; i < 16; i += 2) translation[i] = 1.0;
  EXPECT_NEAR(translation.dot(a.mass * translation), 2700.0 * 0.025 * 0.006, 1e-14);
  EXPECT_LT((a.stiffness * translation).norm(), 1e-9 * a.stiffness.norm());
}

TEST(Assembly, RigidSupportsHoldAnyPlace) {
  Beam beam = slender_beam("free-free", 5);
  // Two in one element, one at a node, a restrained rotation, and one given twice.
  beam.supports = {{.at = 0.23, .stiffness = {}},
                   {.at = 0.31, .stiffness = {}},
                   {.at = 0.6, .stiffness = {}},
                   {.at = 0.93, .deflection = false, .rotation = true, .stiffness = {}}};
  const Defects again{.damages = {}, .supports = {{.location = 0.31}}};
  const Assembly<double> a = assemble<double>(beam, again);
  EXPECT_EQ(a.stiffness.rows(), 12 - 4);
  const TimoshenkoElement<double> element(beam);
  const Eigen::MatrixXd t(a.free_to_all);
  for (const Support& s : beam.supports) {
    const MotionRow<double> row = motion_row(beam, element, s.at, s.rotation);
    const Eigen::RowVectorXd motion = row.coefficients.transpose() * t.middleRows<4>(row.first_dof);
    EXPECT_LT(motion.norm(), 1e-13 * t.middleRows<4>(row.first_dof).norm() / element.length());
  }
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(t).rank(), 8);
}

TEST(Assembly, CountsRigidMotions) {
  for (const auto& [name, expected] :
       {std::pair{"free-free", 2}, {"simply-supported", 0}, {"cantilever", 0}})
    EXPECT_EQ(rigid_body_freedom(slender_beam(name), {}), expected);
  const Beam free = slender_beam("free-free");
  using Added = std::vector<SpringSupport>;
  EXPECT_EQ(rigid_body_freedom(free, Added{{.location = 0.3}}), 1);
  EXPECT_EQ(rigid_body_freedom(free, Added{{.location = 0.3}, {.location = 0.3}}), 1);
  EXPECT_EQ(rigid_body_freedom(free, Added{{.location = 0.3}, {.location = 0.4}}), 0);
  EXPECT_EQ(rigid_body_freedom(free, Added{{.location = 0.3, .rotation = true}}), 1);
  EXPECT_EQ(rigid_body_freedom(free, Added{{.location = 0.1, .rotation = true},
                                           {.location = 0.3, .rotation = true}}),
            1);
}

TEST(Assembly, RejectsDefectsOutOfRange) {
  const Beam beam = slender_beam();
  expect_refusal([&] { validate(beam, Damage{1.01, 0.1}); }, {"damage.location", "1.01", "[0, 1]"});
  expect_refusal([&] { validate(beam, Damage{0.5, 1.0}); }, {"damage.reduction", "1", "[0, 1)"});
  expect_refusal([&] { validate(beam, Damage{0.5, -0.1}); }, {"damage.reduction", "-0.1"});
  expect_refusal([&] { validate(beam, SpringSupport{.location = -0.1}); },
                 {"support.location", "-0.1"});
  expect_refusal([&] { validate(beam, SpringSupport{.location = 0.1, .stiffness = 0.0}); },
                 {"support.stiffness", "0"});
  expect_refusal(
      [&] {
        validate(beam, SpringSupport{.location = 0.1,
                                     .stiffness = std::numeric_limits<double>::quiet_NaN()});
      },
      {"support.stiffness", "nan"});
}

}  // namespace
}  // namespace wheeltap::fem
