// Random changes of structures for reanalysis tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "fem/structures/defects/structure_defects.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::fem {

/// Random terms for a plane or space structure: elements and combinations of their strains with as
/// little as a thousandth of their stiffness, a hundredth to a hundred kilograms more or up to 2 kg
/// less, soft, stiff and rigid springs.
inline StructureChange random_change(const Mesh& mesh, std::mt19937_64& random) {
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
    // Added mass, or removal of part of an element's own.
    const double mass = uniform(random) < 0.5 ? std::pow(10.0, -2.0 + 4.0 * uniform(random))
                                              : -2.0 * uniform(random);
    change.masses = change_of(mesh, {.masses = {{member, s, mass}}}).masses;
  }
  if (uniform(random) < 0.4)
    change.springs.push_back({place(), std::pow(10.0, 3.0 + 6.0 * uniform(random))});
  if (uniform(random) < 0.1)
    change.springs.push_back({place(), std::numeric_limits<double>::infinity()});
  return change;
}

/// One to four defects of every kind for structures of members; cracks only if sections have a
/// depth.
inline StructureDefects random_defects(const Mesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Structure& s = mesh.structure();
  StructureDefects defects;
  const auto pick = [&](std::size_t size) {
    return static_cast<int>(uniform(random) * static_cast<double>(size));
  };
  const auto left = [&] { return std::pow(10.0, -3.0 * uniform(random)); };
  for (int n = 1 + pick(4); n > 0; --n) {
    const int member = pick(s.members.size());
    const double length = mesh.member_length(member), at = uniform(random) * length;
    switch (pick(6)) {
      case 0:
        defects.elements.push_back({member, at, 1.0 - left()});
        break;
      case 1: {
        const double to = at + uniform(random) * (length - at);
        defects.reductions.push_back({member, at, to, 1.0 - left()});
        break;
      }
      case 2:
        defects.cracks.push_back(
            {member, at, 0.9 * uniform(random), &crack_laws()[pick(crack_laws().size())]});
        break;
      case 3:
        defects.joints.push_back({pick(s.nodes.size()), 1.0 - left()});
        break;
      case 4:
        defects.masses.push_back({member, at,
                                  uniform(random) < 0.5
                                      ? std::pow(10.0, -2.0 + 4.0 * uniform(random))
                                      : -2.0 * uniform(random)});
        break;
      default:
        defects.supports.push_back({member, at, uniform(random) < 0.5 ? Direction::x : Direction::y,
                                    uniform(random) < 0.2
                                        ? std::numeric_limits<double>::infinity()
                                        : std::pow(10.0, 3.0 + 6.0 * uniform(random))});
    }
  }
  return defects;
}

}  // namespace wheeltap::fem
