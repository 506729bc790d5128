#include "fem/structures/structure_drawing.hpp"

#include <algorithm>
#include <limits>

namespace wheeltap::fem {
namespace {

using On = StructureDrawing::Point::On;

constexpr std::array<Direction, 3> kTranslations = {Direction::x, Direction::y, Direction::z};
constexpr std::array<Direction, 3> kRotations = {Direction::rx, Direction::ry, Direction::rz};

/// Smallest number of straight pieces of the line of a member.
constexpr int kSegments = 16;

/// Fills in names and size.
void finish(DrawnStructure& out) {
  StructureDrawing& drawing = out.drawing;
  drawing.names = out.discretisation.names;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& point : drawing.points) {
      low = std::min(low, point.at[axis]);
      high = std::max(high, point.at[axis]);
    }
    if (high > low) drawing.size = axis == 0 ? high - low : std::max(drawing.size, high - low);
  }
}

}  // namespace

Vector3 StructureDrawing::Point::moved(const Eigen::VectorXd& shape) const {
  return {translation[0].of(shape), translation[1].of(shape), translation[2].of(shape)};
}

Vector3 StructureDrawing::Point::turned(const Eigen::VectorXd& shape) const {
  return {rotation[0].of(shape), rotation[1].of(shape), rotation[2].of(shape)};
}

DrawnStructure drawn(const Structure& s) {
  const Mesh mesh(s);
  DrawnStructure out{.discretisation = mesh.discretisation(), .drawing = {}};
  StructureDrawing& d = out.drawing;
  d.dimension = s.dimension;
  for (std::size_t n = 0; n < s.nodes.size(); ++n) {
    StructureDrawing::Point point{.on = On::node,
                                  .name = s.nodes[n].name,
                                  .at = s.nodes[n].at,
                                  .translation = {},
                                  .rotation = {}};
    for (std::size_t k = 0; k < 3; ++k) {
      point.translation[k] = mesh.motion(static_cast<int>(n), kTranslations[k]);
      point.rotation[k] = mesh.motion(static_cast<int>(n), kRotations[k]);
    }
    d.points.push_back(std::move(point));
  }
  for (std::size_t m = 0; m < s.members.size(); ++m) {
    const Member& member = s.members[m];
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
      const Mesh::Element& element =
          mesh.elements()[static_cast<std::size_t>(mesh.first_element(index)) + e];
      for (std::size_t i = e == 0 ? 0 : 1; i <= parts; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(parts);
        const double x =
            std::min(element.from + (element.to - element.from) * share, mesh.member_length(index));
        StructureDrawing::Point point{.on = On::member,
                                      .name = member.name,
                                      .along = x,
                                      .at = start,
                                      .translation = {},
                                      .rotation = {}};
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
  }
  for (const NodeSpring& spring : s.springs)
    if (spring.nodes[1] != NodeSpring::kGround)
      d.lines.push_back({spring.nodes[0], spring.nodes[1]});
  finish(out);
  return out;
}

DrawnStructure drawn(const LumpedChain& chain) {
  DrawnStructure out{.discretisation = discretise(chain), .drawing = {}};
  StructureDrawing& d = out.drawing;
  for (std::size_t i = 0; i < chain.masses.size(); ++i)
    d.points.push_back({.on = On::mass,
                        .name = std::to_string(i + 1),
                        .at = {0.0, static_cast<double>(i + 1), 0.0},
                        .translation = {SparseRow{{static_cast<int>(i)}, {1.0}}, {}, {}},
                        .rotation = {}});
  const auto ground = static_cast<int>(d.points.size());
  d.points.push_back({.on = On::ground, .at = {}, .translation = {}, .rotation = {}});
  for (const auto& link : chain.links) {
    const auto point = [&](int mass) { return mass == 0 ? ground : mass - 1; };
    d.lines.push_back({point(link.between[0]), point(link.between[1])});
  }
  finish(out);
  return out;
}

DrawnStructure drawn(const MatrixStructure& matrices) {
  DrawnStructure out{.discretisation = discretise(matrices), .drawing = {}};
  finish(out);
  return out;
}

std::vector<Vector3> point_motions(const StructureDrawing& drawing, const Eigen::VectorXd& shape) {
  std::vector<Vector3> out;
  double largest = 0.0;
  for (const auto& point : drawing.points) {
    out.push_back(point.moved(shape));
    largest = std::max(largest, norm(out.back()));
  }
  for (Vector3& v : out) v = largest > 0.0 ? scaled(v, 1.0 / largest) : Vector3{};
  return out;
}

}  // namespace wheeltap::fem
