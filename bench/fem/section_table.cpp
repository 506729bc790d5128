// Properties of cross-sections on successively finer meshes, compared with known values: the table
// of docs/validation.md.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "fem/sections/section_analysis.hpp"
#include "fem/sections/section_mesh.hpp"

namespace {

using namespace wheeltap::fem;

struct Figure {
  std::string name;
  double known;
  std::function<double(const SectionProperties&)> read;
};

struct Case {
  std::string name;
  Ring outline;
  double poisson;
  std::vector<Figure> figures;
};

double alpha_y(const SectionProperties& p) {
  return p.shear_flexibility.yy;
}
double alpha_z(const SectionProperties& p) {
  return p.shear_flexibility.zz;
}
double torsion(const SectionProperties& p) {
  return p.torsion_constant;
}
double warping(const SectionProperties& p) {
  return p.warping_constant;
}

Ring rectangle(double width, double height) {
  return {{0, 0}, {width, 0}, {width, height}, {0, height}};
}

/// A strip of thickness t bent to the mean radius r, as a polygon of equal area.
Ring curved_strip(double r, double t, double first, double last, int corners) {
  Ring ring;
  const double step = (last - first) / corners, stretch = std::sqrt(step / std::sin(step));
  for (const double side : {0.5, -0.5})
    for (int i = 0; i <= corners; ++i) {
      const double angle = first + step * (side > 0.0 ? i : corners - i);
      ring.emplace_back(stretch * (r + side * t) *
                        Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  return ring;
}

std::vector<Case> cases() {
  const double pi = std::numbers::pi;
  const Ring channel = {{0, 0}, {8.5, 0}, {8.5, 1}, {1, 1}, {1, 18}, {8.5, 18}, {8.5, 19}, {0, 19}};
  const Ring angle = {{0, 0}, {10.5, 0}, {10.5, 1}, {1, 1}, {1, 15.5}, {0, 15.5}};
  const Ring triangle = {{0, 0}, {2.0 / std::sqrt(3.0), 0}, {1.0 / std::sqrt(3.0), 1}};
  return {
      {"rectangle 2 × 1, ν 0", rectangle(2, 1), 0.0, {{"α, short side", 1.2, alpha_z}}},
      {"rectangle 2 × 1, ν 0.3",
       rectangle(2, 1),
       0.3,
       {{"α, short side", 1.27479, alpha_z}, {"α, long side", 1.20056, alpha_y}}},
      {"rectangle 2 × 1, ν 0.5", rectangle(2, 1), 0.5, {{"α, short side", 1.35605, alpha_z}}},
      {"square, ν 0.3",
       rectangle(1, 1),
       0.3,
       {{"α", 1.2074, alpha_y}, {"J / a⁴", 0.140577, torsion}}},
      {"circle, ν 0.3", circle({0, 0}, 1.0), 0.3, {{"α", 1.175542, alpha_y}}},
      {"triangle of height 1", triangle, 0.3, {{"J", 1.0 / (15.0 * std::sqrt(3.0)), torsion}}},
      {"channel, ν 1/3",
       channel,
       1.0 / 3.0,
       {{"α, flanges", 3.4129, alpha_y},
        {"α, web", 2.1548, alpha_z},
        {"J", 11.2682, torsion},
        {"Γ", 12766, warping},
        {"shear centre", 2.8685,
         [](const SectionProperties& p) { return 0.5 - p.centroid.x() - p.shear_centre.x(); }}}},
      {"angle, ν 0",
       angle,
       0.0,
       {{"J", 8.1957, torsion},
        {"α, short leg", 3.0627, alpha_y},
        {"α, long leg", 1.8993, alpha_z}}},
      {"tube with a slit of 9e-5",
       curved_strip(8, 1.25, 0.5 * 9e-5 / 8, 2.0 * pi - 0.5 * 9e-5 / 8, 256),
       0.3,
       {{"J", 32.224, torsion}, {"Γ", 331644, warping}}},
      {"arc of 120°",
       curved_strip(16, 0.5, 0.0, 2.0 * pi / 3.0, 128),
       0.3,
       {{"J", 1.3831, torsion}, {"Γ", 1046.49, warping}}},
  };
}

}  // namespace

int main() {
  std::puts(
      "| section | figure | known | first mesh | then | | the default's | off | stated | s |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|");
  for (const Case& c : cases()) {
    const Outline outline = checked({{{.outer = c.outline, .poisson = c.poisson}}});
    const auto start = std::chrono::steady_clock::now();
    const SectionAnalysis usual =
        analyse_section(section_mesh(outline), outline.regions, {.reference_poisson = c.poisson});
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const SectionAnalysis meshes =
        analyse_section(section_mesh(outline), outline.regions,
                        {.reference_poisson = c.poisson, .least_levels = 3});
    for (const Figure& figure : c.figures) {
      const auto on = [&](std::size_t i) { return figure.read(meshes.levels[i].properties); };
      const double value = figure.read(usual.properties);
      std::printf(
          "| %s | %s | %.7g | %.7g | %.7g | %.7g | %.7g (%d nodes) | %.0e | %.0e | %.2f |\n",
          c.name.c_str(), figure.name.c_str(), figure.known, on(0), on(1), on(2), value,
          usual.levels.back().nodes, std::abs(value / figure.known - 1.0), usual.errors.largest(),
          seconds);
    }
  }
}
