#include "apps/results/structure_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/number.hpp"

namespace wheeltap::apps {
namespace {

using fem::Vector3;
using On = StructureDrawing::Point::On;

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

/// A length as text with four significant digits: "0.5".
std::string metres(double s) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", s);
  return text;
}

/// A point as text: "beam at 0.5 m", "mass 2", "B".
std::string point_in_words(const StructureDrawing::Point& point) {
  switch (point.on) {
    case On::member:
      return point.name + " at " + metres(point.along) + " m";
    case On::mass:
      return "mass " + point.name;
    case On::ground:
      return "the ground";
    case On::node:
      break;
  }
  return point.name;
}

/// Axes of a direction: "x", or "x and y" if the second component is not much smaller.
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
    // Prefer a node whose motion is almost the largest motion.
    const double tie =
        most.point != nullptr && most.point->is_node() && !point.is_node() ? 1.01 : 1.0 + 1e-6;
    if (fem::norm(v) <= most.motion * tie) return;
    most = {fem::norm(v), &point, v};
  };
  for (const auto& point : drawing.points) {
    look(moved, point, point.moved(shape));
    look(turned, point, point.turned(shape));
  }
  const auto at = [](const StructureDrawing::Point& point) {
    return (point.on == On::node ? "node " : "") + point_in_words(point);
  };
  // The mode twists members without deflection.
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
    if (!point.is_node()) continue;
    NodeMotion node{.node = point_in_words(point), .motions = {}};
    const Vector3 moved = point.moved(shape), turned = point.turned(shape);
    const bool chain = point.on == On::mass;
    for (std::size_t k = 0; k < (chain ? 1U : drawing.dimension == 2 ? 2U : 3U); ++k)
      node.motions.emplace_back(kAxes[k], moved[k]);
    if (!chain && drawing.dimension == 2) node.motions.emplace_back("rotation", turned[2]);
    for (std::size_t k = 0; k < 3 && drawing.dimension == 3; ++k)
      node.motions.emplace_back("r" + std::string(kAxes[k]), turned[k]);
    out.push_back(std::move(node));
  }
  return out;
}

std::string vtk_text(const StructureDrawing& drawing, const fem::StructureModes& modes,
                     const std::string& title) {
  if (drawing.points.empty())
    throw std::invalid_argument("matrices have no coordinates: nothing can be drawn");
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
