#include "fem/sections/section_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "refusal.hpp"
#include "sections.hpp"

namespace wheeltap::fem {
namespace {

double area(const TriangleMesh& mesh, int region = -1) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (region >= 0 && mesh.regions[t] != region) continue;
    Ring ring;
    for (const int i : mesh.triangles[t]) ring.push_back(mesh.points[static_cast<std::size_t>(i)]);
    EXPECT_GT(signed_area(ring), 0.0);
    sum += signed_area(ring);
  }
  return sum;
}

double smallest_angle(const TriangleMesh& mesh) {
  double least = 180.0;
  for (const auto& corners : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto p = [&](std::size_t k) {
        return mesh.points[static_cast<std::size_t>(corners[k % 3])];
      };
      const Eigen::Vector2d u = (p(i + 1) - p(i)).normalized(), v = (p(i + 2) - p(i)).normalized();
      least = std::min(least, std::acos(u.dot(v)) * 180.0 / std::numbers::pi);
    }
  return least;
}

TEST(SectionMesh, FillsTheOutlineWithGoodTriangles) {
  const std::vector<Outline> outlines = {
      of_one(rectangle(0, 0, 2, 1), 0.3), of_one(channel(8, 18, 1), 0.3),
      of_one(circle({0, 0}, 1), 0.3, {circle({0.2, 0}, 0.5), circle({-0.6, 0}, 0.1)}),
      of_one(rectangle(0, 0, 100, 0.1), 0.3), of_one(slit_tube(8, 1.25, 1e-7, 128), 0.3)};
  for (const Outline& outline : outlines) {
    const TriangleMesh mesh = section_mesh(outline);
    double expected = signed_area(outline.regions[0].outer);
    for (const Ring& hole : outline.regions[0].holes) expected -= std::abs(signed_area(hole));
    EXPECT_NEAR(area(mesh) / expected, 1.0, 1e-12);
    EXPECT_GE(smallest_angle(mesh), 22.0);
    EXPECT_EQ(pieces(mesh), 1);
  }
}

TEST(SectionMesh, RefinementTerminatesAtSharpCorners) {
  for (const double height : {0.5, 0.1, 0.01}) {
    const TriangleMesh mesh = section_mesh(of_one({{0, 0}, {1, 0}, {1, height}}, 0.3));
    EXPECT_NEAR(area(mesh), 0.5 * height, 1e-14);
    EXPECT_LT(mesh.triangles.size(), 2000u);
  }
  // A star, with five sharp corners.
  Ring star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 ? 0.3 : 1.0, angle = i * std::numbers::pi / 5;
    star.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  EXPECT_NEAR(area(section_mesh(of_one(star, 0.3))), signed_area(star), 1e-14);
}

TEST(SectionMesh, RefinementTerminatesForRandomStars) {
  // Spikes of any sharpness; several meet in one corner if the star is cut in two. Refinement must
  // not change triangles between the shells around such corners.
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int cut = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> angles(static_cast<std::size_t>(3 + 20 * uniform(generator)));
    for (double& angle : angles) angle = 2.0 * std::numbers::pi * uniform(generator);
    std::ranges::sort(angles);
    Ring star;
    const double power = 3.0 * uniform(generator);
    for (const double angle : angles)
      star.emplace_back((0.01 + std::pow(uniform(generator), power)) *
                        Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    Outline outline = of_one(star, 0.3);
    const auto half = static_cast<std::ptrdiff_t>(star.size() / 2);
    const double first = angles.front(), middle = angles[star.size() / 2], last = angles.back();
    if (middle - first < 3.0 && last - middle < 3.0 &&
        first + 2.0 * std::numbers::pi - last < 3.0) {
      Ring one(star.begin(), star.begin() + half + 1), other(star.begin() + half, star.end());
      one.emplace_back(0, 0);
      other.push_back(star[0]);
      other.emplace_back(0, 0);
      outline.regions = {{.outer = one}, {.outer = other}};
      ++cut;
    }
    try {
      outline = checked(outline);
    } catch (const std::invalid_argument&) {
      continue;  // an angle above π between neighbours: it crosses itself
    }
    double expected = 0.0;
    for (const Region& region : outline.regions) expected += signed_area(region.outer);
    const TriangleMesh mesh = section_mesh(outline);
    EXPECT_NEAR(area(mesh) / expected, 1.0, 1e-9) << trial;
    EXPECT_LT(mesh.triangles.size(), 50'000u) << trial;
  }
  EXPECT_GT(cut, 50);
}

TEST(SectionMesh, FacesOfASlitDoNotRefineEachOther) {
  const auto wide = section_mesh(of_one(slit_tube(8, 1.25, 0.1, 128), 0.3)).triangles.size();
  for (const double slit : {1e-4, 1e-6, 1e-9})
    EXPECT_LT(section_mesh(of_one(slit_tube(8, 1.25, slit, 128), 0.3)).triangles.size(), wide + 50);
}

TEST(SectionMesh, RegionsConformAlongSharedEdges) {
  // A wide plate on a narrow web: corners of one lie on an edge of the other; and a filled tube.
  const Outline tee{{{.outer = rectangle(0, 0, 1, 4)}, {.outer = rectangle(-1.3, 4, 2.7, 4.5)}}};
  const TriangleMesh mesh = section_mesh(tee);
  EXPECT_NEAR(area(mesh, 0), 4.0, 1e-12);
  EXPECT_NEAR(area(mesh, 1), 2.0, 1e-12);
  EXPECT_EQ(pieces(mesh), 1);
  // Rotated, so that coordinates are rounded.
  Outline turned = tee;
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (Region& region : turned.regions)
    for (auto& p : region.outer) p = Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
  const TriangleMesh other = section_mesh(turned);
  EXPECT_NEAR(area(other), 6.0, 1e-12);
  EXPECT_EQ(pieces(other), 1);
  const Ring disc = circle({0, 0}, 1);
  const Outline filled{{{.outer = circle({0, 0}, 1.2), .holes = {disc}}, {.outer = disc}}};
  EXPECT_NEAR(area(section_mesh(filled)), 1.44 * std::numbers::pi, 1e-12);
}

TEST(SectionMesh, RejectsMisuse) {
  expect_refusal([] { (void)section_mesh(of_one(rectangle(0, 0, 1, 1), 0.3), {.coarseness = 0}); },
                 {"coarseness", "positive"});
  expect_refusal([] { (void)section_mesh(of_one(rectangle(0, 0, 1, 1), 0.3), {.angle = 45}); },
                 {"angle", "45", "30"});
  expect_refusal(
      [] {
        (void)section_mesh({{{.outer = rectangle(0, 0, 1, 1)}, {.outer = rectangle(2, 0, 3, 1)}}});
      },
      {"2 unconnected parts"});
  // Regions that touch only at a corner are not connected.
  expect_refusal(
      [] {
        (void)section_mesh({{{.outer = rectangle(0, 0, 1, 1)}, {.outer = rectangle(1, 1, 2, 2)}}});
      },
      {"2 unconnected parts"});
  expect_refusal(
      [] {
        (void)section_mesh(of_one(rectangle(0, 0, 1, 1), 0.3),
                           {.coarseness = 1e-3, .most_points = 1000});
      },
      {"1000", "most_points"});
  // Relative to a sliver of 10^12, all corners of the first region coincide, and no mesh remains.
  expect_refusal(
      [] {
        (void)section_mesh({{{.outer = rectangle(0, 0, 0.1, 0.2)},
                             {.outer = {{0.02, 0}, {0.08, 0.5}, {0.08, 1e12}, {0.02, 0.01}}}}});
      },
      {"outline", "fewer than 3 different corners", "billionth"});
}

}  // namespace
}  // namespace wheeltap::fem
