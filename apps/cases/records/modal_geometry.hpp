// Sensor positions of a modal case, and measured shapes as motions of its nodes.
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

/// Parses /geometry: nodes and lines, or the name of a case whose structure gives nodes, members
/// and supported nodes. Throws Failure (65; 66 for a missing file).
[[nodiscard]] Geometry parse_geometry(const CaseFile& file);

/// Unit vector along which a sensor measures, from its direction ("x", "-y") or its angles; empty
/// if it has neither.
[[nodiscard]] std::optional<std::array<double, 3>> direction_of(const MeasuredSensor& sensor);

/// Conversion to {"dimension", "nodes", "lines", "fixed"}, and back. Throws nlohmann exceptions.
[[nodiscard]] Report geometry_json(const Geometry& geometry);
[[nodiscard]] Geometry geometry_of(const Report& json);

/// Input of shapes.js: {"dimension", "drawing": {"points", "lines", "modes": [{"frequency_hz",
/// "motions", "quadrature"}], "as"}}. The displacement of a node is the one of minimum norm that
/// agrees with its sensors. Each shape is rotated by principal_angle(), and its largest
/// displacement is 1. Nodes without sensors, except fixed nodes, and the lines to them are drawn at
/// rest only. Null if no sensor is at a node of the geometry.
[[nodiscard]] Report modal_drawing(const Geometry& geometry, const MeasuredModes& modes);

/// The phase by which a complex shape is rotated to minimise its imaginary part: arg(Σ φ²)/2 over
/// the measured entries.
[[nodiscard]] double principal_angle(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace wheeltap::apps
