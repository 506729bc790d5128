// Where the sensors of a modal case are, and measured shapes as motions of what they stand on.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

struct Geometry {
  int dimension = 2;
  std::map<std::string, std::array<double, 3>> nodes = {};  ///< [m]
  std::vector<std::vector<std::string>> lines = {};         ///< of nodes
  std::vector<std::string> fixed = {};                      ///< nodes that do not move
};

/// The block at /geometry: nodes and lines, or the name of a case with a structure, whose nodes,
/// members and supported nodes are taken. Throws Failure (65; 66 for a file that is not there).
[[nodiscard]] Geometry parse_geometry(const CaseFile& file);

/// Unit vector that a sensor measures along, of its direction ("x", "-y") or its angles; nothing
/// where neither says it.
[[nodiscard]] std::optional<std::array<double, 3>> direction_of(const MeasuredSensor& sensor);

/// {"dimension", "nodes", "lines", "fixed"}, and back. Throws nlohmann exceptions.
[[nodiscard]] Report geometry_json(const Geometry& geometry);
[[nodiscard]] Geometry geometry_of(const Report& json);

/// What shapes.js draws of modes: {"dimension", "drawing": {"points", "lines", "modes":
/// [{"frequency_hz", "motions", "quadrature"}], "as"}}. A node moves by the least displacement
/// that its sensors measure, turned so that the shape is as real as it can be, the largest
/// scaled to 1. Nodes that nothing measures, and the lines to them, are drawn at rest only, but
/// fixed ones. Null where no sensor is at a node of the geometry.
[[nodiscard]] Report modal_drawing(const Geometry& geometry, const MeasuredModes& modes);

/// Angle by which a shape is turned to be as real as it can be: arg(Σ φ²)/2 over what is measured.
[[nodiscard]] double principal_angle(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace wheeltap::apps
