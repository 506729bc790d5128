#include "fem/structures/structure_drawing.hpp"

#include <gtest/gtest.h>

namespace wheeltap::fem {
namespace {

using On = StructureDrawing::Point::On;

TEST(StructureDrawing, ChainsStandOnTheGround) {
  LumpedChain chain;
  chain.masses = {1.0, 2.0};
  chain.links = {{.name = "1", .between = {0, 1}, .stiffness = 1.0},
                 {.name = "2", .between = {1, 2}, .stiffness = 1.0}};
  const StructureDrawing drawing = drawn(chain).drawing;
  ASSERT_EQ(drawing.points.size(), 3U);
  EXPECT_EQ(drawing.points[1].on, On::mass);
  EXPECT_EQ(drawing.points[1].name, "2");
  EXPECT_EQ(drawing.points[2].on, On::ground);
  EXPECT_EQ(drawing.lines, (std::vector<std::vector<int>>{{2, 0}, {0, 1}}));
  EXPECT_EQ(drawing.size, 2.0);
  const auto motions = point_motions(drawing, Eigen::Vector2d(-1.0, 4.0));
  EXPECT_EQ(motions[0][0], -0.25);
  EXPECT_EQ(motions[1][0], 1.0);
  EXPECT_EQ(motions[2][0], 0.0);
}

}  // namespace
}  // namespace wheeltap::fem
