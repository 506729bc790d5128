// The plane frames of the benchmarks.
#pragma once

#include "fem/structures/structure.hpp"

namespace wheeltap::bench {

/// Returns a frame with storeys of 3 m and bays of 5 m, clamped at its feet. Each storey is shifted
/// horizontally by 0.1 m. Each post has `of_posts` elements, each beam `of_beams`.
inline fem::Structure frame(int storeys, int bays, int of_posts, int of_beams) {
  using namespace fem;
  const Material material{.young = 210e9, .poisson = 0.3, .density = 7850.0};
  const MemberSection section{.area = 6e-3, .second_moment_y = 2e-5, .shear_coefficient_z = 0.5};
  Structure s{.dimension = 2, .nodes = {}, .members = {}};
  for (int storey = 0; storey <= storeys; ++storey)
    for (int side = 0; side <= bays; ++side)
      s.nodes.push_back({"n", {5.0 * side + 0.1 * storey, 3.0 * storey, 0.0}});
  const auto add = [&](int a, int b, int elements) {
    const auto line = difference(s.nodes[static_cast<std::size_t>(b)].at,
                                 s.nodes[static_cast<std::size_t>(a)].at);
    s.members.push_back({.name = "m",
                         .nodes = {a, b},
                         .elements = elements,
                         .pieces = {{.to = norm(line), .material = material, .section = section}}});
  };
  for (int storey = 0; storey < storeys; ++storey)
    for (int side = 0; side <= bays; ++side) {
      const int foot = storey * (bays + 1) + side, head = foot + bays + 1;
      add(foot, head, of_posts);
      if (side > 0) add(head - 1, head, of_beams);
    }
  for (int foot = 0; foot <= bays; ++foot)
    s.supports.push_back({.node = foot, .fix = {true, true, true, true, true, true}});
  return s;
}

}  // namespace wheeltap::bench
