#include "fem/structures/structure_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "fem/modal_analysis.hpp"
#include "fem/section.hpp"

namespace wheeltap::fem {
namespace {

constexpr double kPi = std::numbers::pi;

MemberSection rectangle(double width, double height, double kappa) {
  const double b = std::min(width, height), h = std::max(width, height), r = b / h;
  return {.area = width * height,
          .second_moment_y = width * height * height * height / 12.0,
          .second_moment_z = height * width * width * width / 12.0,
          .torsion_constant = h * b * b * b * (1.0 / 3.0 - 0.21 * r * (1.0 - r * r * r * r / 12.0)),
          .shear_coefficient_z = kappa,
          .shear_coefficient_y = kappa,
          .depth = height};
}

Member member(const Structure& s, std::string name, int a, int b, int elements, Material material,
              MemberSection section) {
  const Vector3 line = difference(s.nodes[static_cast<std::size_t>(b)].at,
                                  s.nodes[static_cast<std::size_t>(a)].at);
  return {.name = std::move(name),
          .nodes = {a, b},
          .elements = elements,
          .pieces = {{.to = norm(line), .material = material, .section = section}}};
}

void expect_frequencies(const StructureModes& modes, const std::vector<double>& expected,
                        double relative) {
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(modes.frequencies_hz[static_cast<Eigen::Index>(i)], expected[i],
                relative * expected[i])
        << "mode " << i + 1;
  EXPECT_TRUE(modes.certified) << modes.solver;
}

/// Eight arms of 5 m in a plane, pinned at their outer ends, rigidly joined (NAFEMS FV4-like).
Structure cross_of_arms(int elements, double kappa) {
  const Material material{.young = 200e9, .poisson = 0.3, .density = 8000.0};
  Structure s{.dimension = 2, .nodes = {{"hub", {0.0, 0.0, 0.0}}}, .members = {}};
  for (int i = 0; i < 8; ++i) {
    const double angle = kPi / 4.0 * i;
    s.nodes.push_back(
        {"tip " + std::to_string(i + 1), {5.0 * std::cos(angle), 5.0 * std::sin(angle), 0.0}});
    s.members.push_back(member(s, "arm " + std::to_string(i + 1), 0, i + 1, elements, material,
                               rectangle(0.125, 0.125, kappa)));
    s.supports.push_back({.node = i + 1, .fix = {true, true}});
  }
  return s;
}

TEST(StructureModes, EightArms) {
  const StructureModes modes =
      structure_modes(Mesh(cross_of_arms(24, 5.0 / 6.0)).discretisation(), 9);
  expect_frequencies(modes,
                     {11.3243, 17.6368, 17.6368, 17.6652, 17.6652, 17.6652, 17.6652, 17.6652,
                      45.157},
                     1e-4);
}

}  // namespace
}  // namespace wheeltap::fem
