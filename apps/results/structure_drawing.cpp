#include "apps/results/structure_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/number.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using fem::Direction;
using fem::Vector3;

constexpr std::array<Direction, 3> kTranslations = {Direction::x, Direction::y, Direction::z};
constexpr std::array<Direction, 3> kRotations = {Direction::rx, Direction::ry, Direction::rz};
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

/// Straight pieces of a member's line, at least.
constexpr int kSegments = 16;

/// "0.5", with three digits more than a part in a thousand of the size.
std::string metres(double s) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", s);
  return text;
}

Vector3 values(const std::array<fem::SparseRow, 3>& rows, const Eigen::VectorXd& shape) {
  return {rows[0].of(shape), rows[1].of(shape), rows[2].of(shape)};
}

void measure_extent(StructureDrawing& drawing) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& point : drawing.points) {
      low = std::min(low, point.at[axis]);
      high = std::max(high, point.at[axis]);
    }
    if (high > low) drawing.size = axis == 0 ? high - low : std::max(drawing.size, high - low);
  }
}

DrawnStructure drawn_members(const fem::Structure& s) {
  const fem::Mesh mesh(s);
  DrawnStructure out{.discretisation = mesh.discretisation(), .drawing = {}};
  StructureDrawing& d = out.drawing;
  d.dimension = s.dimension;
  for (std::size_t n = 0; n < s.nodes.size(); ++n) {
    StructureDrawing::Point point{.place = s.nodes[n].name,
                                  .at = s.nodes[n].at,
                                  .translation = {},
                                  .rotation = {},
                                  .node = true};
    for (std::size_t k = 0; k < 3; ++k) {
      point.translation[k] = mesh.motion(static_cast<int>(n), kTranslations[k]);
      point.rotation[k] = mesh.motion(static_cast<int>(n), kRotations[k]);
    }
    d.points.push_back(std::move(point));
  }
  for (std::size_t m = 0; m < s.members.size(); ++m) {
    const fem::Member& member = s.members[m];
    const int index = static_cast<int>(m);
    Vector3 start = s.nodes[static_cast<std::size_t>(member.nodes[0])].at;
    for (std::size_t k = 0; k < 3; ++k) start[k] += member.ends[0].offset[k];
    const Vector3& along = mesh.member_axes(index)[0];
    const auto elements = static_cast<std::size_t>(
        (m + 1 < s.members.size() ? mesh.first_element(index + 1)
                                  : static_cast<int>(mesh.elements().size())) -
        mesh.first_element(index));
    const std::size_t parts = (kSegments + elements - 1) / elements;
    std::vector<int> line = {};
    for (std::size_t e = 0; e < elements; ++e) {
      const fem::Mesh::Element& element =
          mesh.elements()[static_cast<std::size_t>(mesh.first_element(index)) + e];
      for (std::size_t i = e == 0 ? 0 : 1; i <= parts; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(parts);
        const double x =
            std::min(element.from + (element.to - element.from) * share, mesh.member_length(index));
        StructureDrawing::Point point{.place = member.name + " at " + metres(x) + " m",
                                      .at = start,
                                      .translation = {},
                                      .rotation = {},
                                      .node = false};
        for (std::size_t k = 0; k < 3; ++k) {
          point.at[k] += x * along[k];
          if (s.dimension == 2 && k == 2) {
            point.rotation[k] = mesh.motion(index, x, Direction::rz);
            continue;
          }
          point.translation[k] = mesh.motion(index, x, kTranslations[k]);
          if (s.dimension == 3) point.rotation[k] = mesh.motion(index, x, kRotations[k]);
        }
        line.push_back(static_cast<int>(d.points.size()));
        d.points.push_back(std::move(point));
      }
    }
    d.lines.push_back(std::move(line));
    d.line_names.push_back(member.name);
  }
  for (std::size_t i = 0; i < s.springs.size(); ++i)
    if (s.springs[i].nodes[1] != fem::NodeSpring::kGround) {
      d.lines.push_back({s.springs[i].nodes[0], s.springs[i].nodes[1]});
      d.line_names.push_back("spring " + std::to_string(i + 1));
    }
  return out;
}

DrawnStructure drawn_chain(const fem::LumpedChain& chain) {
  DrawnStructure out{.discretisation = fem::discretise(chain), .drawing = {}};
  StructureDrawing& d = out.drawing;
  for (std::size_t i = 0; i < chain.masses.size(); ++i)
    d.points.push_back({.place = "mass " + std::to_string(i + 1),
                        .at = {0.0, static_cast<double>(i + 1), 0.0},
                        .translation = {fem::SparseRow{{static_cast<int>(i)}, {1.0}}, {}, {}},
                        .rotation = {},
                        .node = true});
  const auto ground = static_cast<int>(d.points.size());
  d.points.push_back(
      {.place = "the ground", .at = {}, .translation = {}, .rotation = {}, .node = false});
  for (const auto& link : chain.links) {
    const auto point = [&](int mass) { return mass == 0 ? ground : mass - 1; };
    d.lines.push_back({point(link.between[0]), point(link.between[1])});
    d.line_names.push_back(link.name);
  }
  return out;
}

/// "x", or "x and y" where a second component is not much less.
std::string axes_of(const Vector3& v) {
  double largest = 0.0;
  for (const double x : v) largest = std::max(largest, std::abs(x));
  std::string text;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(v[k]) >= 0.5 * largest && largest > 0.0)
      text += (text.empty() ? "" : " and ") + std::string(kAxes[k]);
  return text;
}

}  // namespace

DrawnStructure drawn(const AnyStructure& structure) {
  DrawnStructure out;
  if (const auto* members = std::get_if<fem::Structure>(&structure))
    out = drawn_members(*members);
  else if (const auto* chain = std::get_if<fem::LumpedChain>(&structure))
    out = drawn_chain(*chain);
  else
    out.discretisation = discretise(structure);
  out.drawing.names = out.discretisation.names;
  measure_extent(out.drawing);
  return out;
}

std::string largest_motion(const StructureDrawing& drawing, const Eigen::VectorXd& shape) {
  if (drawing.points.empty()) {
    Eigen::Index dof = 0;
    shape.cwiseAbs().maxCoeff(&dof);
    const fem::DofName& name = drawing.names[static_cast<std::size_t>(dof)];
    return name.place + (name.direction.empty() ? "" : ", " + name.direction);
  }
  struct Most {
    double motion = 0.0;
    const StructureDrawing::Point* point = nullptr;
    Vector3 components = {};
  } moved, turned;
  const auto look = [&](Most& most, const StructureDrawing::Point& point, const Vector3& v) {
    // Nodes come first: one that moves almost as much as anything is named.
    const double tie = most.point != nullptr && most.point->node && !point.node ? 1.01 : 1.0 + 1e-6;
    if (fem::norm(v) <= most.motion * tie) return;
    most = {fem::norm(v), &point, v};
  };
  for (const auto& point : drawing.points) {
    look(moved, point, values(point.translation, shape));
    look(turned, point, values(point.rotation, shape));
  }
  const auto at = [](const StructureDrawing::Point& point) {
    return point.node && !point.place.starts_with("mass ") ? "node " + point.place : point.place;
  };
  // Twist without deflection.
  if (turned.point != nullptr && moved.motion < 1e-6 * drawing.size * turned.motion)
    return "rotation of " + at(*turned.point) + " about " + axes_of(turned.components);
  if (moved.point == nullptr) return "";
  return at(*moved.point) + ", " + axes_of(moved.components);
}

std::vector<NodeMotion> node_motions(const StructureDrawing& drawing,
                                     const Eigen::VectorXd& shape) {
  std::vector<NodeMotion> out;
  if (drawing.points.empty()) {
    for (std::size_t i = 0; i < drawing.names.size(); ++i) {
      const fem::DofName& name = drawing.names[i];
      const auto found = std::ranges::find(out, name.place, &NodeMotion::node);
      NodeMotion& node = found == out.end() ? out.emplace_back(NodeMotion{name.place, {}}) : *found;
      node.motions.emplace_back(name.direction, shape[static_cast<Eigen::Index>(i)]);
    }
    return out;
  }
  for (const auto& point : drawing.points) {
    if (!point.node) continue;
    NodeMotion node{.node = point.place, .motions = {}};
    const Vector3 moved = values(point.translation, shape), turned = values(point.rotation, shape);
    const bool chain = point.place.starts_with("mass ");
    for (std::size_t k = 0; k < (chain ? 1U : drawing.dimension == 2 ? 2U : 3U); ++k)
      node.motions.emplace_back(kAxes[k], moved[k]);
    if (!chain && drawing.dimension == 2) node.motions.emplace_back("rotation", turned[2]);
    for (std::size_t k = 0; k < 3 && drawing.dimension == 3; ++k)
      node.motions.emplace_back("r" + std::string(kAxes[k]), turned[k]);
    out.push_back(std::move(node));
  }
  return out;
}

std::vector<Vector3> point_motions(const StructureDrawing& drawing, const Eigen::VectorXd& shape) {
  std::vector<Vector3> out;
  double largest = 0.0;
  for (const auto& point : drawing.points) {
    out.push_back(values(point.translation, shape));
    largest = std::max(largest, fem::norm(out.back()));
  }
  for (Vector3& v : out) v = largest > 0.0 ? fem::scaled(v, 1.0 / largest) : Vector3{};
  return out;
}

std::string vtk_text(const StructureDrawing& drawing, const fem::StructureModes& modes,
                     const std::string& title) {
  if (drawing.points.empty())
    throw std::invalid_argument("matrices have no places: there is nothing to draw");
  const auto row = [](const Vector3& v) {
    return base::number(v[0]) + ' ' + base::number(v[1]) + ' ' + base::number(v[2]) + '\n';
  };
  // The second line is the title: one line of at most 255 bytes.
  std::string name = title.substr(0, 200);
  std::ranges::replace(name, '\n', ' ');
  std::string text = "# vtk DataFile Version 3.0\n" + name + "\nASCII\nDATASET POLYDATA\n";
  const std::string count = std::to_string(drawing.points.size());
  text += "POINTS " + count + " double\n";
  for (const auto& point : drawing.points) text += row(point.at);
  std::size_t corners = 0;
  for (const auto& line : drawing.lines) corners += line.size() + 1;
  text += "LINES " + std::to_string(drawing.lines.size()) + ' ' + std::to_string(corners) + '\n';
  for (const auto& line : drawing.lines) {
    text += std::to_string(line.size());
    for (const int point : line) text += ' ' + std::to_string(point);
    text += '\n';
  }
  text += "POINT_DATA " + count + '\n';
  for (Eigen::Index mode = 0; mode < modes.shapes.cols(); ++mode) {
    char field[64];
    std::snprintf(field, sizeof field, "VECTORS mode_%02d_%.5g_Hz double\n",
                  static_cast<int>(mode) + 1, modes.frequencies_hz[mode]);
    text += field;
    for (const Vector3& v : point_motions(drawing, modes.shapes.col(mode))) text += row(v);
  }
  return text;
}

}  // namespace wheeltap::apps
