// Sensor positions of a modal case, and measured mode shapes as displacements of the geometry's
// nodes.
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
  std::map<std::string, std::array<double, 3>> nodes = {};  ///< coordinates of the nodes [m]
  std::vector<std::vector<std::string>> lines = {};         ///< lines, each a list of node names
  std::vector<std::string> fixed = {};                      ///< nodes that do not move
};

/// Parses /geometry: nodes and lines, or the name of a case whose structure gives nodes, members
/// and supported nodes. Throws Failure (65; 66 for a missing file).
[[nodiscard]] Geometry parse_geometry(const CaseFile& file);

/// Unit vector of the measured direction of a sensor, from its direction ("x", "-y") or its azimuth
/// and elevation; empty if the sensor has neither.
[[nodiscard]] std::optional<std::array<double, 3>> direction_of(const MeasuredSensor& sensor);

/// Converts a geometry to {"dimension", "nodes", "lines", "fixed"}. geometry_of converts this JSON
/// to a geometry; it throws nlohmann exceptions.
[[nodiscard]] Report geometry_json(const Geometry& geometry);
[[nodiscard]] Geometry geometry_of(const Report& json);

/// Input of shapes.js: {"dimension", "drawing": {"points", "lines", "modes": [{"frequency_hz",
/// "motions", "quadrature"}], "as"}}. The displacement of a node is the displacement of minimum
/// norm that agrees with the sensors at the node. Each shape is rotated by principal_angle() and
/// scaled to a largest displacement of 1. Free nodes without a sensor, and lines to these nodes,
/// are drawn only in their undeformed position. The result is null if no sensor is at a node of the
/// geometry.
[[nodiscard]] Report modal_drawing(const Geometry& geometry, const ModesFile& modes);

/// The phase by which a complex shape is rotated to minimise its imaginary part: arg(Σ φ²)/2 over
/// the measured entries.
[[nodiscard]] double principal_angle(const Eigen::Ref<const Eigen::VectorXcd>& shape);

}  // namespace wheeltap::apps
