#include "random_structure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/sections/section.hpp"

namespace wheeltap::coverage {
namespace {

using identification::DamageCase;

constexpr fem::Material kSteel{.young = 210e9, .poisson = 0.3, .density = 7850.0};

double between(base::Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// Section of a rectangle with depth `height` along z. J by Roark's series, 0.2 % of the exact one.
fem::MemberSection rectangle(double width, double height) {
  const fem::Section plane = fem::section(fem::Rectangle{width, height}, kSteel.poisson);
  const double a = std::max(width, height), b = std::min(width, height), q = b / a;
  return {.area = plane.area,
          .second_moment_y = plane.second_moment,
          .second_moment_z = height * width * width * width / 12.0,
          .torsion_constant = a * b * b * b * (1.0 / 3.0 - 0.21 * q * (1.0 - q * q * q * q / 12.0)),
          .shear_coefficient_z = plane.shear_coefficient,
          .shear_coefficient_y = plane.shear_coefficient,
          .depth = height};
}

RandomStructure beam(base::Random& random, DamageCase& into) {
  static constexpr std::array kFamilies = {"simply supported beam", "cantilever", "two-span beam"};
  const auto family = static_cast<std::size_t>(random.index(3));
  const double length = between(random, 1.0, 10.0);
  const double height = length / between(random, 15.0, 40.0);
  const double width = height * between(random, 0.5, 2.0);
  const int elements = 24 + 2 * random.index(7);
  into.beam = {
      .length = length,
      .elements = elements,
      .supports = fem::named_supports(family == 1 ? "cantilever" : "simply-supported", length),
      .material = kSteel,
      .section = fem::section(fem::Rectangle{width, height}, kSteel.poisson)};
  into.beam_depth = height;
  if (family == 2) {
    const auto node = static_cast<int>(elements * between(random, 0.35, 0.65));
    into.beam.supports.push_back({.at = node * into.beam.element_length(), .stiffness = {}});
  }
  return {
      .family = kFamilies[family], .mass = kSteel.density * width * height * length, .joints = {}};
}

/// Adds members one by one, and their mass up.
struct Builder {
  fem::Structure structure;
  double mass = 0.0;

  void add(int a, int b, int elements, const fem::MemberSection& section, double joint) {
    const auto at = [&](int n) { return structure.nodes[static_cast<std::size_t>(n)]; };
    const double length = fem::norm(fem::difference(at(b).at, at(a).at));
    fem::Member m{.name = at(a).name + "-" + at(b).name,
                  .nodes = {a, b},
                  .elements = elements,
                  .pieces = {{.to = length, .material = kSteel, .section = section}}};
    for (fem::MemberEnd& end : m.ends) end.rotation.fill(joint);
    structure.members.push_back(m);
    mass += kSteel.density * section.area * length;
  }
};

fem::MemberSection random_section(base::Random& random) {
  const double height = between(random, 0.15, 0.4);
  return rectangle(height * between(random, 0.4, 1.0), height);
}

RandomStructure frame(base::Random& random, DamageCase& into) {
  const int bays = 1 + random.index(3), storeys = 1 + random.index(3), columns = bays + 1;
  Builder b{.structure = {.dimension = 2, .nodes = {}, .members = {}}};
  std::vector<double> x = {0.0}, y = {0.0};
  for (int i = 0; i < bays; ++i) x.push_back(x.back() + between(random, 3.0, 8.0));
  for (int i = 0; i < storeys; ++i) y.push_back(y.back() + between(random, 2.8, 4.5));
  for (std::size_t level = 0; level < y.size(); ++level)
    for (std::size_t column = 0; column < x.size(); ++column)
      b.structure.nodes.push_back(
          {std::string(1, static_cast<char>('A' + column)) + std::to_string(level),
           {x[column], y[level], 0.0}});
  const fem::MemberSection post = random_section(random), girder = random_section(random);
  for (int level = 0; level < storeys; ++level)
    for (int column = 0; column < columns; ++column) {
      const int foot = columns * level + column;
      b.add(foot, foot + columns, 3, post, fem::MemberEnd::kRigid);
    }
  // Semi-rigid joints of 2 to 20 E I / L of the first bay.
  const double joint = random.index(2) == 0 ? fem::MemberEnd::kRigid
                                            : kSteel.young * girder.second_moment_y / x[1] *
                                                  between(random, 2.0, 20.0);
  for (int level = 1; level <= storeys; ++level)
    for (int bay = 0; bay < bays; ++bay)
      b.add(columns * level + bay, columns * level + bay + 1, 3, girder, joint);
  RandomStructure out{.family = "frame " + std::to_string(bays) + "x" + std::to_string(storeys),
                      .mass = b.mass,
                      .joints = {}};
  for (int foot = 0; foot < columns; ++foot) {
    const bool clamped = random.uniform() < 0.7;  // or pinned
    b.structure.supports.push_back({.node = foot, .fix = {true, true, true, true, true, clamped}});
  }
  for (int node = columns; node < columns * (storeys + 1); ++node) out.joints.push_back(node);
  into.structure = std::make_shared<const identification::StructureModel>(
      identification::StructureModel{.nominal = b.structure});
  return out;
}

RandomStructure portal(base::Random& random, DamageCase& into) {
  Builder b{.structure = {.dimension = 3, .nodes = {}, .members = {}}};
  const double wide = between(random, 3.0, 7.0), deep = between(random, 3.0, 7.0);
  const double high = between(random, 2.8, 5.0);
  for (int level = 0; level < 2; ++level)
    for (int corner = 0; corner < 4; ++corner)
      b.structure.nodes.push_back(
          {std::string(1, static_cast<char>('A' + corner)) + std::to_string(level),
           {corner == 1 || corner == 2 ? wide : 0.0, corner >= 2 ? deep : 0.0, level * high}});
  const fem::MemberSection post = random_section(random), girder = random_section(random);
  for (int corner = 0; corner < 4; ++corner)
    b.add(corner, corner + 4, 3, corner == 0 ? random_section(random) : post,
          fem::MemberEnd::kRigid);
  for (int corner = 0; corner < 4; ++corner)
    b.add(4 + corner, 4 + (corner + 1) % 4, 3, girder, fem::MemberEnd::kRigid);
  for (int foot = 0; foot < 4; ++foot)
    b.structure.supports.push_back({.node = foot, .fix = {true, true, true, true, true, true}});
  into.structure = std::make_shared<const identification::StructureModel>(
      identification::StructureModel{.nominal = b.structure});
  return {.family = "space portal", .mass = b.mass, .joints = {4, 5, 6, 7}};
}

RandomStructure building(base::Random& random, DamageCase& into) {
  const int storeys = 3 + random.index(6);
  fem::LumpedChain chain;
  for (int i = 0; i < storeys; ++i) {
    chain.masses.push_back(1e5 * between(random, 0.7, 1.3));
    chain.links.push_back(
        {"storey " + std::to_string(i + 1), {i, i + 1}, 2e8 * between(random, 0.6, 1.4)});
  }
  into.structure = std::make_shared<const identification::StructureModel>(
      identification::StructureModel{.nominal = chain});
  return {.family = "building of " + std::to_string(storeys), .mass = 0.0, .joints = {}};
}

}  // namespace

RandomStructure random_structure(base::Random& random, DamageCase& into) {
  // Of ten: four beams, three plane frames, a portal, two buildings.
  const int which = random.index(10);
  if (which < 4) return beam(random, into);
  if (which < 7) return frame(random, into);
  if (which < 8) return portal(random, into);
  return building(random, into);
}

}  // namespace wheeltap::coverage
