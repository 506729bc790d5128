#include "fem/structures/structure_reanalysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fem/structures/structure_defects.hpp"
#include "fem/structures/structure_modes.hpp"

namespace wheeltap::fem {
namespace {

/// A portal of three members on a clamped and a pinned foot, with a brace.
Structure portal(int elements, int dimension) {
  const Material material{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  const MemberSection section{.area = 6e-3,
                              .second_moment_y = 2e-5,
                              .second_moment_z = 8e-6,
                              .torsion_constant = 3e-6,
                              .shear_coefficient_z = 0.5,
                              .shear_coefficient_y = 0.6,
                              .depth = 0.2};
  Structure s{.dimension = dimension,
              .nodes = {{"A", {0, 0, 0}}, {"B", {0, 3, 0}}, {"C", {5, 3.5, 0}}, {"D", {5, 0, 0}}},
              .members = {}};
  if (dimension == 3) s.nodes[2].at[2] = 1.0;
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 3}, {0, 2}}) {
    Member m{.name = "m" + std::to_string(s.members.size()), .nodes = {a, b}, .elements = elements};
    const Vector3 line = difference(s.nodes[static_cast<std::size_t>(b)].at,
                                    s.nodes[static_cast<std::size_t>(a)].at);
    m.pieces = {{.to = norm(line), .material = material, .section = section}};
    s.members.push_back(m);
  }
  s.members[1].ends[0].rotation.fill(3e6);
  s.supports = {{.node = 0, .fix = {true, true, true, true, true, true}},
                {.node = 3, .fix = {true, true, true}}};
  return s;
}

StructureChange random_change(const Mesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  StructureChange change;
  std::vector<int> elements;
  for (int n = 1 + static_cast<int>(3.0 * uniform(random)); n > 0; --n) {
    const auto e = static_cast<int>(uniform(random) * static_cast<double>(mesh.elements().size()));
    if (std::ranges::find(elements, e) != elements.end()) continue;
    elements.push_back(e);
    const double left = std::pow(10.0, -3.0 * uniform(random));
    const auto& strains = mesh.elements()[static_cast<std::size_t>(e)].strains;
    if (uniform(random) < 0.5) {
      for (const int row : strains)
        if (row >= 0) change.softenings.push_back({{{row, 1.0}}, left});
    } else {  // as a crack: one combination of a moment and a shear force
      const double angle = uniform(random);
      change.softenings.push_back(
          {{{strains[static_cast<std::size_t>(ElementStrain::bending_z)], std::cos(angle)},
            {strains[static_cast<std::size_t>(ElementStrain::shear_z)], std::sin(angle)}},
           left});
    }
  }
  const auto place = [&] {
    const auto member = static_cast<int>(uniform(random) * 4.0);
    const auto direction = uniform(random) < 0.5 ? Direction::x : Direction::y;
    return mesh.motion(member, uniform(random) * mesh.member_length(member), direction);
  };
  if (uniform(random) < 0.4) {
    const int member = static_cast<int>(uniform(random) * 4.0);
    const double s = uniform(random) * mesh.member_length(member);
    // Gained, or a part of an element's own lost.
    const double mass = uniform(random) < 0.5 ? std::pow(10.0, -2.0 + 4.0 * uniform(random))
                                              : -2.0 * uniform(random);
    change.masses = change_of(mesh, {.masses = {{member, s, mass}}}).masses;
  }
  if (uniform(random) < 0.4)
    change.springs.push_back({place(), std::pow(10.0, 3.0 + 6.0 * uniform(random))});
  return change;
}

TEST(StructureReanalysis, AgreesWithFullSolutions) {
  for (const int dimension : {2, 3}) {
    for (const bool free : {false, true}) {
      Structure s = portal(dimension == 2 ? 12 : 6, dimension);
      if (free) s.supports.clear();
      const Mesh mesh(s);
      const auto d = std::make_shared<const Discretisation>(mesh.discretisation());
      const StructureReanalysis reanalysis(d, 16);
      auto workspace = reanalysis.make_workspace();
      std::mt19937_64 random(11);
      double worst = 0.0;
      for (int trial = 0; trial < 60; ++trial) {
        const StructureChange change = random_change(mesh, random);
        std::vector<double> f(12);
        reanalysis.solve(change, workspace, {.frequencies_hz = f});
        const StructureModes full = structure_modes(changed(*d, change), 12);
        for (std::size_t i = 0; i < f.size(); ++i) {
          const double exact = full.frequencies_hz[static_cast<Eigen::Index>(i)];
          const double error = exact == 0.0 ? f[i] : std::abs(f[i] / exact - 1.0);
          worst = std::max(worst, error);
          EXPECT_LT(error, 3e-9) << "dimension " << dimension << ", free " << free << ", trial "
                                 << trial << ", mode " << i << ": " << f[i] << " for " << exact;
        }
      }
      RecordProperty("worst", std::to_string(worst));
    }
  }
}

}  // namespace
}  // namespace wheeltap::fem
