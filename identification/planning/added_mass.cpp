#include "identification/planning/added_mass.hpp"

#include <cmath>
#include <stdexcept>

#include "base/index.hpp"
#include "base/number.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::identification::planning {

/// Largest distance of a mass from the end of an element, in elements.
constexpr double kAtAnEnd = 1e-6;

AnyStructure with_mass_at_node(const AnyStructure& structure, int node, double mass) {
  AnyStructure out = structure;
  if (auto* members = std::get_if<fem::Structure>(&out)) {
    if (node < 0 || node >= static_cast<int>(members->nodes.size()))
      throw std::invalid_argument("the structure has no node " + std::to_string(node));
    members->masses.push_back({.node = node, .mass = mass});
  } else if (auto* chain = std::get_if<fem::LumpedChain>(&out)) {
    if (node < 0 || node >= static_cast<int>(chain->masses.size()))
      throw std::invalid_argument("the chain has no mass " + std::to_string(node + 1));
    chain->masses[index(node)] += mass;
  } else {
    throw std::invalid_argument("a structure given by matrices has no nodes for added masses");
  }
  return out;
}

AnyStructure with_mass_on_beam(const fem::Structure& beam, double x, double mass) {
  fem::Structure out = beam;
  double left = x;
  for (std::size_t m = 0; m < out.members.size(); ++m) {
    const fem::MemberFrame frame = fem::member_frame(out, static_cast<int>(m));
    if (left > frame.length * (1.0 + 1e-9)) {
      left -= frame.length;
      continue;
    }
    fem::Member& first = out.members[m];
    const double elements = left / frame.length * first.elements;
    const int before = static_cast<int>(std::lround(elements));
    if (std::abs(elements - before) > kAtAnEnd) {
      const double size = frame.length / first.elements,
                   low = x - left + std::floor(elements) * size;
      throw std::invalid_argument("must be at an end of an element: the nearest ends are at " +
                                  base::significant(low, 6) + " and " +
                                  base::significant(low + size, 6) + " m");
    }
    if (before == 0 || before == first.elements) {
      out.masses.push_back({.node = first.nodes[before == 0 ? 0 : 1], .mass = mass});
      return out;
    }
    const double cut = frame.length * before / first.elements;
    const fem::Vector3 from = out.nodes[index(first.nodes[0])].at;
    const int added = static_cast<int>(out.nodes.size());
    out.nodes.push_back({.name = "mass",
                         .at = {from[0] + cut * frame.axes[0][0], from[1] + cut * frame.axes[0][1],
                                from[2] + cut * frame.axes[0][2]}});
    fem::Member second = first;
    second.name += " after the mass";
    second.nodes[0] = added;
    second.elements = first.elements - before;
    second.pieces.back().to = frame.length - cut;
    second.ends[0] = {};
    first.nodes[1] = added;
    first.elements = before;
    first.pieces.back().to = cut;
    first.ends[1] = {};
    out.members.insert(out.members.begin() + static_cast<std::ptrdiff_t>(m) + 1, std::move(second));
    out.masses.push_back({.node = added, .mass = mass});
    return out;
  }
  throw std::invalid_argument("the mass is outside the beam");
}

}  // namespace wheeltap::identification::planning
