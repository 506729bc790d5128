#include "fem/sections/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace wheeltap::fem {
namespace {

/// An L of three unit squares with the re-entrant corner at (1, 1); its right square is region 1.
TriangleMesh ell() {
  return {.points = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}},
          .triangles = {{0, 1, 4}, {0, 4, 7}, {1, 2, 3}, {1, 3, 4}, {7, 4, 5}, {7, 5, 6}},
          .regions = {0, 0, 0, 0, 0, 0}};
}

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto p = [&](std::size_t i) { return mesh.points[static_cast<std::size_t>(t[i])]; };
    const Eigen::Vector2d u = p(1) - p(0), v = p(2) - p(0);
    const double one = 0.5 * (u.x() * v.y() - u.y() * v.x());
    EXPECT_GT(one, 0.0);
    sum += one;
  }
  return sum;
}

/// Every edge belongs to two triangles or lies on the boundary, whose length is known.
void expect_conforming(const TriangleMesh& mesh, double perimeter) {
  const EdgeNumbers edges = number_edges(mesh);
  double length = 0.0;
  for (std::size_t e = 0; e < edges.ends.size(); ++e)
    if (edges.triangles[e][1] < 0)
      length += (mesh.points[static_cast<std::size_t>(edges.ends[e][0])] -
                 mesh.points[static_cast<std::size_t>(edges.ends[e][1])])
                    .norm();
  EXPECT_NEAR(length, perimeter, 1e-12);
  // Euler: V - E + T = 1 for a disc.
  EXPECT_EQ(static_cast<int>(mesh.points.size()) - static_cast<int>(edges.ends.size()) +
                static_cast<int>(mesh.triangles.size()),
            1);
}

TEST(TriangleMesh, EdgesAreShared) {
  const EdgeNumbers edges = number_edges(ell());
  EXPECT_EQ(edges.ends.size(), 13u);
  EXPECT_EQ(std::ranges::count_if(edges.triangles, [](const auto& t) { return t[1] < 0; }), 8);
  expect_conforming(ell(), 8.0);
  EXPECT_EQ(pieces(ell()), 1);
  TriangleMesh two = ell();
  two.triangles = {two.triangles[0], two.triangles[5]};
  EXPECT_EQ(pieces(two), 2);
}

TEST(TriangleMesh, RefinementIsGradedToReentrantCorners) {
  TriangleMesh mesh = ell();
  std::vector<double> shares = split_shares(mesh);
  // λ = 2/3 at the corner of 270°: 2^(-2/λ) = 1/8.
  for (std::size_t i = 0; i < shares.size(); ++i)
    EXPECT_NEAR(shares[i], i == 4 ? 0.125 : 0.5, 1e-12) << i;
  mesh = refined(mesh, shares);
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_EQ(shares.size(), mesh.points.size());
  EXPECT_NEAR(area(mesh), 3.0, 1e-14);
  expect_conforming(mesh, 8.0);
  double nearest = 9.0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (i != 4) nearest = std::min(nearest, (mesh.points[i] - mesh.points[4]).norm());
  EXPECT_NEAR(nearest, 0.125, 1e-15);
}

TEST(TriangleMesh, RingsAreAddedAroundReentrantCorners) {
  TriangleMesh mesh = ell();
  std::vector<double> shares = split_shares(mesh);
  mesh = ringed(std::move(mesh), shares, 3);
  // Four triangles meet at the corner: two more of each per ring.
  EXPECT_EQ(mesh.triangles.size(), 6u + 3 * 2 * 4);
  EXPECT_EQ(shares.size(), mesh.points.size());
  EXPECT_NEAR(area(mesh), 3.0, 1e-14);
  expect_conforming(mesh, 8.0);
}

TEST(TriangleMesh, GradesAtEndsAndCornersOfInterfaces) {
  TriangleMesh mesh = ell();
  mesh.regions = {0, 0, 1, 1, 0, 0};
  const std::vector<double> shares = split_shares(mesh);
  EXPECT_EQ(shares[1], 0.0625);
  EXPECT_EQ(shares[4], 0.0625);
  EXPECT_EQ(shares[0], 0.5);
}

}  // namespace
}  // namespace wheeltap::fem
