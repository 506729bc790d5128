#include "fem/structures/structure.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/index.hpp"

namespace wheeltap::fem {
namespace {

using Part = InvalidStructure::Part;

/// Members shorter than this share of the structure's size have no defined direction.
constexpr double kNoLength = 1e-9;

std::string number(double x) {
  std::ostringstream text;
  text.precision(12);
  text << x;
  return text.str();
}

void require(bool holds, Part part, std::size_t i, const std::string& what, double value,
             const char* allowed) {
  if (holds) return;
  throw InvalidStructure(part, static_cast<int>(i), what + " = " + number(value) + ": " + allowed);
}

bool positive(double x) {
  return x > 0.0 && std::isfinite(x);
}

/// The largest extent of the nodes [m].
double size(const Structure& s) {
  double largest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = INFINITY, high = -INFINITY;
    for (const Node& node : s.nodes) {
      low = std::min(low, node.at[axis]);
      high = std::max(high, node.at[axis]);
    }
    largest = std::max(largest, high - low);
  }
  return largest;
}

void validate_node(const Structure& s, int node, Part part, std::size_t i, const char* what) {
  if (node >= 0 && index(node) < s.nodes.size()) return;
  throw InvalidStructure(part, static_cast<int>(i),
                         std::string(what) + " = " + std::to_string(node) +
                             ": must be below the number of nodes, " +
                             std::to_string(s.nodes.size()));
}

void validate_member(const Structure& s, std::size_t i) {
  const Member& m = s.members[i];
  const std::string who = "member \"" + m.name + "\": ";
  for (const int node : m.nodes) validate_node(s, node, Part::members, i, "node");
  require(m.elements >= 1, Part::members, i, who + "elements", m.elements, "must be at least 1");
  const double length = member_frame(s, static_cast<int>(i)).length;
  if (m.pieces.empty())
    throw InvalidStructure(Part::members, static_cast<int>(i),
                           who + "has neither material nor section");
  double before = 0.0;
  for (const Member::Piece& piece : m.pieces) {
    require(piece.to > before, Part::members, i, who + "the end of a segment", piece.to,
            "must be greater than the end of the previous segment");
    before = piece.to;
    const auto check = [&](const char* name, double value, bool holds, const char* allowed) {
      require(holds, Part::members, i, who + name, value, allowed);
    };
    const auto check_positive = [&](const char* name, double value) {
      check(name, value, positive(value), "must be positive");
    };
    check_positive("young", piece.material.young);
    check("poisson", piece.material.poisson,
          piece.material.poisson > -1.0 && piece.material.poisson < 0.5,
          "must be above -1 and below 0.5");
    check("density", piece.material.density,
          piece.material.density >= 0.0 && std::isfinite(piece.material.density),
          "must not be negative");
    check_positive("section area", piece.section.area);
    check_positive("second moment", piece.section.second_moment_y);
    const auto check_shear = [&](const char* name, double value) {
      check(name, value, value > 0.0, "must be positive");
    };
    check_shear("shear coefficient", piece.section.shear_coefficient_z);
    if (s.dimension == 3) {
      check_positive("second moment about z", piece.section.second_moment_z);
      check_positive("torsion constant", piece.section.torsion_constant);
      check_shear("shear coefficient along y", piece.section.shear_coefficient_y);
    }
  }
  require(std::abs(before - length) <= 1e-6 * length, Part::members, i,
          who + "the end of the last segment", before,
          ("must be the member's length, " + number(length) + " m").c_str());
  for (const MemberEnd& end : m.ends)
    for (const double stiffness : end.rotation)
      require(stiffness >= 0.0, Part::members, i, who + "the stiffness of an end", stiffness,
              "must not be negative");
  require(std::isfinite(m.axial_force), Part::members, i, who + "axial force", m.axial_force,
          "must be finite");
  require(m.foundation >= 0.0 && std::isfinite(m.foundation), Part::members, i, who + "foundation",
          m.foundation, "must not be negative");
}

}  // namespace

std::string direction_name(Direction d, int dimension) {
  static constexpr std::array<const char*, kDirections> names = {"x", "y", "z", "rx", "ry", "rz"};
  if (dimension == 2 && d == Direction::rz) return "rotation";
  return names[static_cast<std::size_t>(d)];
}

MemberFrame member_frame(const Structure& s, int member) {
  const Member& m = s.members[index(member)];
  const Node &first = s.nodes[index(m.nodes[0])], &second = s.nodes[index(m.nodes[1])];
  Vector3 along = difference(second.at, first.at);
  for (std::size_t axis = 0; axis < 3; ++axis)
    along[axis] += m.ends[1].offset[axis] - m.ends[0].offset[axis];
  const double length = norm(along);
  const std::string who = "member \"" + m.name + "\": ";
  if (!(length > kNoLength * size(s)))
    throw InvalidStructure(
        Part::members, member,
        who + "its ends at " + first.name + " and " + second.name + " coincide: it has no length");
  MemberFrame frame{.axes = {scaled(along, 1.0 / length), Vector3{}, Vector3{}}, .length = length};
  const Vector3& x = frame.axes[0];
  if (s.dimension == 2) {
    frame.axes[2] = {-x[1], x[0], 0.0};
    frame.axes[1] = {0.0, 0.0, -1.0};
    return frame;
  }
  Vector3 up = m.up;
  if (norm(up) == 0.0) up = std::hypot(x[0], x[1]) > 1e-6 ? Vector3{0, 0, 1} : Vector3{0, 1, 0};
  const Vector3 y = cross(up, x);
  if (!(norm(y) > 1e-6 * norm(up)))
    throw InvalidStructure(
        Part::members, member,
        who + "\"up\" is parallel to the member: the axes of its section are undefined");
  frame.axes[1] = scaled(y, 1.0 / norm(y));
  frame.axes[2] = cross(x, frame.axes[1]);
  return frame;
}

std::vector<double> element_boundaries(const Structure& s, int member) {
  const Member& m = s.members[index(member)];
  const double length = member_frame(s, member).length;
  std::vector<double> places;
  for (int e = 0; e <= m.elements; ++e) places.push_back(length * e / m.elements);
  for (const Member::Piece& piece : m.pieces) {
    const auto near = [&](double place) { return std::abs(place - piece.to) <= 1e-6 * length; };
    if (std::ranges::none_of(places, near)) places.push_back(piece.to);
  }
  std::ranges::sort(places);
  return places;
}

void validate(const Structure& s) {
  if (s.dimension != 2 && s.dimension != 3)
    throw InvalidStructure(Part::whole, 0,
                           "dimension = " + std::to_string(s.dimension) + ": must be 2 or 3");
  if (s.nodes.empty()) throw InvalidStructure(Part::whole, 0, "has no nodes");
  if (s.members.empty() && s.springs.empty())
    throw InvalidStructure(Part::whole, 0, "has neither members nor springs: nothing is elastic");
  for (std::size_t i = 0; i < s.nodes.size(); ++i)
    for (const double coordinate : s.nodes[i].at)
      require(std::isfinite(coordinate), Part::nodes, i, "node \"" + s.nodes[i].name + "\"",
              coordinate, "coordinates must be finite");
  for (std::size_t i = 0; i < s.members.size(); ++i) validate_member(s, i);
  for (std::size_t i = 0; i < s.supports.size(); ++i) {
    validate_node(s, s.supports[i].node, Part::supports, i, "node");
    for (const double stiffness : s.supports[i].stiffness)
      require(stiffness >= 0.0 && std::isfinite(stiffness), Part::supports, i, "stiffness",
              stiffness, "must be finite and not negative");
  }
  for (std::size_t i = 0; i < s.masses.size(); ++i) {
    validate_node(s, s.masses[i].node, Part::masses, i, "node");
    require(s.masses[i].mass >= 0.0 && std::isfinite(s.masses[i].mass), Part::masses, i, "mass",
            s.masses[i].mass, "must be finite and not negative");
    for (const double inertia : s.masses[i].inertia)
      require(inertia >= 0.0 && std::isfinite(inertia), Part::masses, i, "inertia", inertia,
              "must be finite and not negative");
  }
  for (std::size_t i = 0; i < s.springs.size(); ++i) {
    const NodeSpring& spring = s.springs[i];
    validate_node(s, spring.nodes[0], Part::springs, i, "node");
    if (spring.nodes[1] != NodeSpring::kGround)
      validate_node(s, spring.nodes[1], Part::springs, i, "node");
    require(spring.stiffness >= 0.0 && std::isfinite(spring.stiffness), Part::springs, i,
            "stiffness", spring.stiffness, "must be finite and not negative");
    if (spring.direction != NodeSpring::kAlong) continue;
    const bool ground = spring.nodes[1] == NodeSpring::kGround;
    if (ground || !(norm(difference(s.nodes[index(spring.nodes[1])].at,
                                    s.nodes[index(spring.nodes[0])].at)) > kNoLength * size(s)))
      throw InvalidStructure(Part::springs, static_cast<int>(i),
                             ground ? "a spring to ground needs a direction"
                                    : "its nodes coincide: it needs a direction");
  }
}

Structure as_structure(const Beam& beam, double depth) {
  validate(beam);
  Structure s{.dimension = 2, .nodes = {}, .members = {}};
  s.axial = false;
  const MemberSection section{.area = beam.section.area,
                              .second_moment_y = beam.section.second_moment,
                              .shear_coefficient_z = beam.section.shear_coefficient,
                              .depth = depth};
  const auto mesh_node = [&](double x) {
    const double nearest = std::round(x / beam.element_length());
    if (std::abs(x - nearest * beam.element_length()) > 1e-9 * beam.length)
      throw std::invalid_argument("support at " + number(x) + " m: must be at a node of the mesh");
    return static_cast<int>(nearest);
  };
  std::vector<int> at = {0, beam.elements};
  for (const Support& support : beam.supports) at.push_back(mesh_node(support.at));
  std::ranges::sort(at);
  at.erase(std::unique(at.begin(), at.end()), at.end());
  for (const int n : at)
    s.nodes.push_back({.name = number(n * beam.element_length()) + " m",
                       .at = {n * beam.element_length(), 0.0, 0.0}});
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double length = s.nodes[i + 1].at[0] - s.nodes[i].at[0];
    s.members.push_back(
        {.name = "beam",
         .nodes = {static_cast<int>(i), static_cast<int>(i) + 1},
         .elements = at[i + 1] - at[i],
         .pieces = {{.to = length, .material = beam.material, .section = section}}});
  }
  for (const Support& support : beam.supports) {
    const auto node = std::ranges::find(at, mesh_node(support.at)) - at.begin();
    NodeSupport held{.node = static_cast<int>(node)};
    for (const auto& [wanted, direction] : {std::pair{support.deflection, Direction::y},
                                            std::pair{support.rotation, Direction::rz}}) {
      if (!wanted) continue;
      const auto d = static_cast<std::size_t>(direction);
      if (support.stiffness) {
        held.stiffness[d] = *support.stiffness;
      } else {
        held.fix[d] = true;
      }
    }
    s.supports.push_back(held);
  }
  return s;
}

}  // namespace wheeltap::fem
