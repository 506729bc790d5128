// The frame for tests with few modes, all modes and full solutions.
#pragma once

#include <string>
#include <utility>

#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// A portal of three members on a clamped and a pinned foot, with a brace.
inline Structure braced_portal(int elements, int dimension) {
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

}  // namespace wheeltap::fem
