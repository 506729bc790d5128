#include "apps/report/section_figure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/report/report.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {
namespace {

using Eigen::Vector2d;

constexpr const char* kCentroid = "fill=\"#222\"";
constexpr const char* kShearCentre = "fill=\"none\" stroke=\"#c2571a\" stroke-width=\"2\"";
constexpr double kInside = 420.0, kSketchMargin = 46.0, kLegend = 92.0;  // [px]

/// Converts metres to pixels of the sheet.
struct Sheet {
  Vector2d low, high;
  double scale;

  [[nodiscard]] std::string at(const Vector2d& p) const {
    return fixed(x(p), 2) + " " + fixed(y(p), 2);
  }
  [[nodiscard]] double x(const Vector2d& p) const {
    return kSketchMargin + scale * (p.x() - low.x());
  }
  [[nodiscard]] double y(const Vector2d& p) const {
    return kSketchMargin + scale * (high.y() - p.y());
  }
  [[nodiscard]] double width() const { return 2.0 * kSketchMargin + scale * (high.x() - low.x()); }
  [[nodiscard]] double height() const { return 2.0 * kSketchMargin + scale * (high.y() - low.y()); }
};

std::string arrow(double x1, double y1, double x2, double y2, const std::string& name) {
  const double angle = std::atan2(y2 - y1, x2 - x1);
  std::string path =
      "<path d=\"M" + fixed(x1, 1) + " " + fixed(y1, 1) + "L" + fixed(x2, 1) + " " + fixed(y2, 1);
  for (const double turn : {2.7, -2.7})
    path += "M" + fixed(x2, 1) + " " + fixed(y2, 1) + "l" + fixed(6 * std::cos(angle + turn), 1) +
            " " + fixed(6 * std::sin(angle + turn), 1);
  return path + "\" fill=\"none\" stroke=\"#666\"/>\n" +
         svg_text(x2 + 9 * std::cos(angle) - 3, y2 + 9 * std::sin(angle) + 4, name);
}

}  // namespace

std::string section_figure(const MeshedSection& section, const std::string& title) {
  const fem::SectionProperties& p = section.analysis.properties;
  const Vector2d centre = p.centroid + p.shear_centre;
  Sheet sheet{.low = centre, .high = centre, .scale = 1.0};
  for (const auto& point : section.mesh.points) {
    sheet.low = sheet.low.cwiseMin(point);
    sheet.high = sheet.high.cwiseMax(point);
  }
  const double size = (sheet.high - sheet.low).maxCoeff();
  sheet.scale = kInside / size;
  std::string body;
  // Draw triangles with thin lines and one shade per material.
  static const char* shades[] = {"#dde7f3", "#f3e3d6", "#e0efdf", "#efe0ee"};
  for (std::size_t r = 0; r < section.outline.regions.size(); ++r) {
    std::string path;
    const auto add = [&](const fem::Ring& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) path += (i ? "L" : "M") + sheet.at(ring[i]);
      path += "Z";
    };
    add(section.outline.regions[r].outer);
    for (const fem::Ring& hole : section.outline.regions[r].holes) add(hole);
    body += "<path d=\"" + path + "\" fill=\"" + shades[r % 4] + "\" fill-rule=\"evenodd\"/>\n";
  }
  std::string mesh, rim;
  const fem::EdgeNumbers edges = fem::number_edges(section.mesh);
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    const auto [s, t] = edges.triangles[e];
    const bool border = t < 0 || section.mesh.regions[static_cast<std::size_t>(s)] !=
                                     section.mesh.regions[static_cast<std::size_t>(t)];
    (border ? rim : mesh) += "M" + sheet.at(section.mesh.points[static_cast<std::size_t>(a)]) +
                             "L" + sheet.at(section.mesh.points[static_cast<std::size_t>(b)]);
  }
  body += "<path d=\"" + mesh + "\" fill=\"none\" stroke=\"#b9c7d8\" stroke-width=\"0.6\"/>\n";
  body += "<path d=\"" + rim + "\" fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"1.6\"/>\n";
  // Draw the principal axes through the centroid.
  const fem::PrincipalAxes axes = fem::principal_axes(p.second_moments);
  for (const int k : {1, 2}) {
    const double angle = axes.angle + (k == 2 ? 0.5 * std::numbers::pi : 0.0);
    const Vector2d along(std::cos(angle), std::sin(angle));
    const double reach = 0.28 * size;
    const Vector2d from = p.centroid - reach * along, to = p.centroid + reach * along;
    body += "<path d=\"M" + sheet.at(from) + "L" + sheet.at(to) +
            "\" stroke=\"#444\" stroke-dasharray=\"9 3 2 3\"/>\n";
    body += svg_text(sheet.x(to) + 4, sheet.y(to) - 4, std::to_string(k));
  }
  const double cx = sheet.x(p.centroid), cy = sheet.y(p.centroid);
  body += svg_dot(kCentroid, cx, cy, 4.0);
  const double sx = sheet.x(centre), sy = sheet.y(centre);
  body += "<path d=\"M" + fixed(sx - 8, 1) + " " + fixed(sy, 1) + "h16M" + fixed(sx, 1) + " " +
          fixed(sy - 8, 1) + "v16\" stroke=\"#c2571a\" stroke-width=\"2\"/>\n" +
          svg_dot(kShearCentre, sx, sy, 5.0);
  const double left = kSketchMargin, below = sheet.height();
  body += arrow(14, sheet.height() - 14, 44, sheet.height() - 14, "y");
  body += arrow(14, sheet.height() - 14, 14, sheet.height() - 44, "z");
  body += svg_dot(kCentroid, left + 4, below + 14, 4.0);
  body += svg_text(left + 16, below + 18,
                   "centroid (" + significant(p.centroid.x(), 5) + ", " +
                       significant(p.centroid.y(), 5) + ") m");
  body += svg_dot(kShearCentre, left + 4, below + 34, 5.0);
  body += svg_text(
      left + 16, below + 38,
      "shear centre (" + significant(centre.x(), 5) + ", " + significant(centre.y(), 5) + ") m");
  body += svg_text(left, below + 58,
                   "1, 2: principal axes, I1 = " + significant(axes.largest, 5) +
                       " m⁴, I2 = " + significant(axes.smallest, 5) + " m⁴");
  // Draw a scale bar: a round length below a third of the width.
  double bar = std::pow(10.0, std::floor(std::log10(size / 3.0)));
  for (const double more : {5.0, 2.0})
    if (more * bar <= size / 3.0) {
      bar *= more;
      break;
    }
  body += "<path d=\"M" + fixed(left, 1) + " " + fixed(below + 74, 1) + "h" +
          fixed(bar * sheet.scale, 1) + "\" stroke=\"#222\" stroke-width=\"2\"/>\n";
  body += svg_text(left + bar * sheet.scale + 8, below + 78, significant(bar, 2) + " m");
  return svg_sheet(std::max(sheet.width(), 430.0), below + kLegend, html_text(title), body);
}

}  // namespace wheeltap::apps
