// Parametric structures for tests of reduced bases.
#pragma once

#include <memory>
#include <vector>

#include "base/random.hpp"
#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/matrix_structure.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/parametric_modes.hpp"

namespace wheeltap::fem::parametric {

/// Uniform in the box, reproducible.
inline std::vector<std::vector<double>> draws(const std::vector<std::array<double, 2>>& box,
                                              int count, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  std::vector<std::vector<double>> out(static_cast<std::size_t>(count));
  for (auto& theta : out)
    for (const auto& [low, high] : box) theta.push_back(low + (high - low) * random.uniform());
  return out;
}

/// A chain of masses; link i between masses i - 1 and i has stiffness θ_i; the first joins the
/// ground.
inline StructureFamily shear_chain(int storeys, bool grounded = true) {
  const auto at = [=](std::span<const double> theta) {
    LumpedChain chain{.masses = std::vector<double>(static_cast<std::size_t>(storeys), 2.0),
                      .links = {}};
    for (int i = grounded ? 0 : 1; i < storeys; ++i)
      chain.links.push_back({.name = "link",
                             .between = {i, i + 1},
                             .stiffness = theta[static_cast<std::size_t>(i) % theta.size()]});
    return discretise(chain);
  };
  return {.at = at, .nominal = {1000.0, 1200.0}};
}

/// A plane portal frame with unknown E of posts and beam, density, and height of the posts, and a
/// rotational spring at the right foot.
inline Structure portal(double young_posts, double young_beam, double density, double height,
                        double axial_force = 0.0) {
  const auto section = [](double width, double h) {
    return MemberSection{.area = width * h,
                         .second_moment_y = width * h * h * h / 12.0,
                         .second_moment_z = h * width * width * width / 12.0,
                         .torsion_constant = 1e-9,
                         .shear_coefficient_z = 5.0 / 6.0,
                         .shear_coefficient_y = 5.0 / 6.0,
                         .depth = h};
  };
  Structure s{.dimension = 2,
              .nodes = {{"A", {0, 0, 0}}, {"B", {0, 1, 0}}, {"C", {1.5, 1, 0}}, {"D", {1.5, 0, 0}}},
              .members = {}};
  const auto add = [&](std::string name, int a, int b, double length, double young, double h) {
    s.members.push_back(
        {.name = std::move(name),
         .nodes = {a, b},
         .elements = 30,
         .pieces = {{.to = length,
                     .material = {.young = young, .poisson = 0.3, .density = density},
                     .section = section(0.05, h)}},
         .axial_force = axial_force});
  };
  add("left post", 0, 1, 1.0, young_posts, height);
  add("beam", 1, 2, 1.5, young_beam, 0.012);
  add("right post", 2, 3, 1.0, young_posts, height);
  s.supports.push_back({.node = 0, .fix = {true, true, false, false, false, true}});
  s.supports.push_back({.node = 3, .fix = {true, true}, .stiffness = {0, 0, 0, 0, 0, 1e3}});
  return s;
}

/// Parameters: E of posts and beam, and the density.
inline StructureFamily portal_materials() {
  return {.at =
              [](std::span<const double> x) {
                return Mesh(portal(x[0], x[1], x[2], 0.01)).discretisation();
              },
          .nominal = {200e9, 70e9, 7800.0}};
}

/// A row of `storeys` rigid floors as matrices with three substructures. Each floor has two masses
/// and a massless joint between them: one of 3 degrees of freedom per floor has no mass.
inline MatrixStructure floors(int storeys) {
  const int n = 3 * storeys;
  MatrixStructure s;
  std::vector<Eigen::Triplet<double>> mass;
  std::vector<std::vector<Eigen::Triplet<double>>> parts(3);
  const auto spring = [&](std::size_t part, int a, int b, double k) {
    parts[part].emplace_back(b, b, k);
    if (a < 0) return;
    parts[part].emplace_back(a, a, k);
    parts[part].emplace_back(a, b, -k);
    parts[part].emplace_back(b, a, -k);
  };
  for (int i = 0; i < storeys; ++i) {
    const int low = 3 * i;
    mass.emplace_back(low, low, 1.0);
    mass.emplace_back(low + 2, low + 2, 0.7);
    spring(0, low - 1, low, 900.0);
    spring(1, low, low + 1, 1500.0);
    spring(2, low + 1, low + 2, 700.0 + 10.0 * i);
    if (i > 0) spring(1, low - 3, low + 1, 400.0);
  }
  s.mass.resize(n, n);
  s.mass.setFromTriplets(mass.begin(), mass.end());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    MatrixStructure::Part part{.name = "part " + std::to_string(p), .stiffness = {}};
    part.stiffness.resize(n, n);
    part.stiffness.setFromTriplets(parts[p].begin(), parts[p].end());
    s.parts.push_back(std::move(part));
  }
  return s;
}

/// Parameters: the changes α of its parts.
inline StructureFamily family_of(const MatrixStructure& matrices) {
  const auto s = std::make_shared<const MatrixStructure>(matrices);
  StructureFamily family{.at =
                             [s](std::span<const double> x) {
                               MatrixStructure changed = *s;
                               for (std::size_t p = 0; p < x.size(); ++p)
                                 changed.parts[p].change = x[p];
                               return discretise(changed);
                             },
                         .nominal = std::vector<double>(s->parts.size()),
                         .parts = {},
                         .scales =
                             [](std::span<const double> x) {
                               std::vector<double> scales;
                               for (const double change : x) scales.push_back(1.0 + change);
                               return scales;
                             }};
  for (const auto& part : s->parts) family.parts.push_back(part.stiffness);
  return family;
}

}  // namespace wheeltap::fem::parametric
