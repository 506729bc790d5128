#include "apps/cases/records/modal_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/eigen_solvers.hpp"

namespace wheeltap::apps {
namespace {

using Eigen::Index;
using Coordinates = std::array<double, 3>;

std::string name_at(const CaseFile& file, const Pointer& where, const Geometry& geometry) {
  std::string name = text_or_number(file.json.at(where));
  if (!geometry.nodes.contains(name)) file.refuse(where, "is not a node of the geometry");
  return name;
}

Geometry of_nodes(const CaseFile& file, const Pointer& where) {
  Geometry out;
  for (const auto& [name, at] : file.json.at(where / "nodes").items()) {
    Coordinates place{};
    for (std::size_t k = 0; k < at.size(); ++k) place[k] = at[k].get<double>();
    if (at.size() == 3) out.dimension = 3;
    out.nodes[name] = place;
  }
  return out;
}

Geometry of_structure(const CaseFile& file) {
  const CaseFile other = read_case(file.resolve(file.json.at("geometry").get<std::string>()));
  const Pointer where("/structure");
  const auto refuse = [&](const std::string& what) {
    file.refuse(Pointer("/geometry"), "names a case " + what);
  };
  if (!other.json.contains(where) || !other.json.at(where).is_object() ||
      !other.json.at(where).contains("nodes"))
    refuse("without a structure of nodes and members");
  try {
    Geometry out = of_nodes(other, where);
    for (const Json& member : other.json.at(where).value("members", Json::array()))
      out.lines.push_back({member.at("nodes").at(0).get<std::string>(),
                           member.at("nodes").at(1).get<std::string>()});
    for (const Json& support : other.json.at(where).value("supports", Json::array()))
      out.fixed.push_back(support.at("node").get<std::string>());
    for (const auto& line : out.lines)
      for (const std::string& node : line)
        if (!out.nodes.contains(node)) refuse("whose members name a missing node: " + node);
    return out;
  } catch (const Json::exception& error) {
    refuse(std::string("whose structure cannot be read: ") + error.what());
  }
  return {};
}

/// Displacement of a node in a mode: the minimum-norm displacement that agrees with its sensors.
struct MovedNode {
  std::string name;
  Eigen::MatrixXd directions = {};  ///< sensors × 3
  std::vector<Index> sensors = {};
  [[nodiscard]] Eigen::Vector3cd motion(const Eigen::Ref<const Eigen::VectorXcd>& shape) const {
    std::vector<Index> rows;
    for (std::size_t i = 0; i < sensors.size(); ++i)
      if (std::isfinite(shape[sensors[i]].real())) rows.push_back(static_cast<Index>(i));
    if (rows.empty()) return Eigen::Vector3cd::Zero();
    Eigen::MatrixXd d(static_cast<Index>(rows.size()), 3), y(static_cast<Index>(rows.size()), 2);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto row = static_cast<Index>(i);
      const std::complex<double> entry = shape[sensors[static_cast<std::size_t>(rows[i])]];
      d.row(row) = directions.row(rows[i]);
      y.row(row) << entry.real(), entry.imag();
    }
    const Eigen::MatrixXd u =
        Eigen::BDCSVD<Eigen::MatrixXd>(d, Eigen::ComputeThinU | Eigen::ComputeThinV)
            .setThreshold(1e-3)
            .solve(y);
    Eigen::Vector3cd out;
    out.real() = u.col(0);
    out.imag() = u.col(1);
    return out;
  }
};

std::vector<MovedNode> moved_nodes(const Geometry& geometry,
                                   const std::vector<MeasuredSensor>& sensors) {
  std::vector<MovedNode> out;
  for (std::size_t c = 0; c < sensors.size(); ++c) {
    const auto along = direction_of(sensors[c]);
    if (!along || !geometry.nodes.contains(sensors[c].node)) continue;
    auto found = std::ranges::find(out, sensors[c].node, &MovedNode::name);
    if (found == out.end()) found = out.insert(out.end(), MovedNode{.name = sensors[c].node});
    found->sensors.push_back(static_cast<Index>(c));
    found->directions.conservativeResize(static_cast<Index>(found->sensors.size()), 3);
    found->directions.bottomRows(1) << (*along)[0], (*along)[1], (*along)[2];
  }
  return out;
}

}  // namespace

Geometry parse_geometry(const CaseFile& file) {
  const Pointer where("/geometry");
  if (file.json.at(where).is_string()) return of_structure(file);
  Geometry out = of_nodes(file, where);
  for (const char* key : {"lines", "fixed"}) {
    const std::size_t count = file.json.at(where).value(key, Json::array()).size();
    for (std::size_t i = 0; i < count; ++i) {
      const Pointer one = where / key / i;
      if (key == std::string("fixed")) {
        out.fixed.push_back(name_at(file, one, out));
        continue;
      }
      out.lines.emplace_back();
      for (std::size_t k = 0; k < file.json.at(one).size(); ++k)
        out.lines.back().push_back(name_at(file, one / k, out));
    }
  }
  return out;
}

std::optional<std::array<double, 3>> direction_of(const MeasuredSensor& sensor) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  if (sensor.azimuth || sensor.elevation) {
    const double a = kDegree * sensor.azimuth.value_or(0.0),
                 e = kDegree * sensor.elevation.value_or(0.0);
    return Coordinates{std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  }
  std::string axis = sensor.direction;
  const double sign = axis.starts_with('-') ? -1.0 : 1.0;
  if (axis.starts_with('-') || axis.starts_with('+')) axis.erase(0, 1);
  if (axis == "x") return Coordinates{sign, 0.0, 0.0};
  if (axis == "y") return Coordinates{0.0, sign, 0.0};
  if (axis == "z") return Coordinates{0.0, 0.0, sign};
  return {};
}

Report geometry_json(const Geometry& geometry) {
  Report nodes = Report::object();
  for (const auto& [name, at] : geometry.nodes) nodes[name] = at;
  return {{"dimension", geometry.dimension},
          {"nodes", nodes},
          {"lines", geometry.lines},
          {"fixed", geometry.fixed}};
}

Geometry geometry_of(const Report& json) {
  Geometry out{.dimension = json.at("dimension").get<int>()};
  for (const auto& [name, at] : json.at("nodes").items())
    out.nodes[name] = at.get<std::array<double, 3>>();
  out.lines = json.at("lines").get<std::vector<std::vector<std::string>>>();
  out.fixed = json.at("fixed").get<std::vector<std::string>>();
  return out;
}

double principal_angle(const Eigen::Ref<const Eigen::VectorXcd>& shape) {
  std::complex<double> sum = 0.0;
  for (const std::complex<double>& entry : shape)
    if (std::isfinite(entry.real())) sum += entry * entry;
  return 0.5 * std::arg(sum);
}

Report modal_drawing(const Geometry& geometry, const ModesFile& modes) {
  const std::vector<MovedNode> moved = moved_nodes(geometry, modes.sensors);
  if (moved.empty()) return {};
  // Points: all nodes undeformed, then the moving nodes again, so that lines can show both.
  Report points = Report::array(), lines = Report::array(), shapes = Report::array();
  std::map<std::string, std::size_t> rest, now;
  for (const auto& [name, at] : geometry.nodes) {
    rest[name] = points.size();
    points.push_back(at);
  }
  for (const std::string& name : geometry.fixed) now[name] = rest.at(name);
  for (const MovedNode& node : moved) {
    now[node.name] = points.size();
    points.push_back(geometry.nodes.at(node.name));
    lines.push_back({rest.at(node.name), now.at(node.name)});
  }
  for (const auto& line : geometry.lines)
    for (std::size_t i = 1; i < line.size(); ++i) {
      const auto a = now.find(line[i - 1]), b = now.find(line[i]);
      if (a != now.end() && b != now.end())
        lines.push_back({a->second, b->second});
      else
        lines.push_back({rest.at(line[i - 1]), rest.at(line[i])});
    }
  for (Index m = 0; m < modes.frequencies_hz.size(); ++m) {
    const std::complex<double> turn = std::polar(1.0, -principal_angle(modes.shapes.col(m)));
    std::vector<Eigen::Vector3cd> motions(geometry.nodes.size(), Eigen::Vector3cd::Zero());
    double largest = 0.0;
    for (const MovedNode& node : moved) {
      motions.push_back(turn * node.motion(modes.shapes.col(m)));
      largest = std::max(largest, motions.back().norm());
    }
    Report real = Report::array(), imaginary = Report::array();
    for (const Eigen::Vector3cd& u : motions) {
      const double scale = largest > 0.0 ? 1.0 / largest : 0.0;
      real.push_back({scale * u[0].real(), scale * u[1].real(), scale * u[2].real()});
      imaginary.push_back({scale * u[0].imag(), scale * u[1].imag(), scale * u[2].imag()});
    }
    shapes.push_back(
        {{"frequency_hz", modes.frequencies_hz[m]}, {"motions", real}, {"quadrature", imaginary}});
  }
  return {{"dimension", geometry.dimension},
          {"drawing",
           {{"points", points},
            {"lines", lines},
            {"modes", shapes},
            {"as", "as measured; nodes without sensors are drawn undeformed"}}}};
}

}  // namespace wheeltap::apps
