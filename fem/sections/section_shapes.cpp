#include "fem/sections/section_shapes.hpp"

#include <algorithm>

namespace wheeltap::fem {
namespace {

double cube(double x) {
  return x * x * x;
}

/// A rectangle about the origin.
Ring middle(double width, double height) {
  const double y = 0.5 * width, z = 0.5 * height;
  return {{-y, -z}, {y, -z}, {y, z}, {-y, z}};
}

}  // namespace

const std::vector<SectionShape>& section_shapes() {
  using S = std::span<const double>;
  static const std::vector<SectionShape> list = {
      {"rectangle",
       {"width", "height"},
       [](S s, double nu) { return section(Rectangle{.width = s[0], .height = s[1]}, nu); },
       [](S s) { return s[1] * cube(s[0]) / 12.0; },
       [](S, double nu) { return cowper_rectangle(nu); },
       [](S s) { return rectangle_torsion_constant(s[0], s[1]); },
       [](S s) { return s[1]; },
       [](S s) { return Region{.outer = middle(s[0], s[1])}; }},
      {"circle",
       {"diameter"},
       [](S s, double nu) { return section(Circle{s[0]}, nu); },
       [](S s) { return section(Circle{s[0]}, 0.0).second_moment; },
       [](S, double nu) { return cowper_circle(nu); },
       [](S s) { return 2.0 * section(Circle{s[0]}, 0.0).second_moment; },
       [](S s) { return s[0]; },
       [](S s) {
         return Region{.outer = circle({0, 0}, 0.5 * s[0])};
       }},
      {"tube",
       {"outer_diameter", "thickness"},
       [](S s, double nu) {
         return section(Tube{s[0], s[1]}, nu);
       },
       [](S s) {
         return section(Tube{s[0], s[1]}, 0.0).second_moment;
       },
       [](S s, double nu) {
         return section(Tube{s[0], s[1]}, nu).shear_coefficient;
       },
       [](S s) {
         return 2.0 * section(Tube{s[0], s[1]}, 0.0).second_moment;
       },
       [](S s) { return s[0]; },
       [](S s) {
         return Region{.outer = circle({0, 0}, 0.5 * s[0]),
                       .holes = {circle({0, 0}, 0.5 * s[0] - s[1])}};
       }},
      {"i",
       {"height", "width", "flange_thickness", "web_thickness"},
       [](S s, double nu) {
         return section(ISection{s[0], s[1], s[2], s[3]}, nu);
       },
       [](S s) { return (2.0 * s[2] * cube(s[1]) + (s[0] - 2.0 * s[2]) * cube(s[3])) / 12.0; },
       nullptr,
       nullptr,
       [](S s) { return s[0]; },
       [](S s) {
         const double y = 0.5 * s[1], z = 0.5 * s[0], web = 0.5 * s[3], in = z - s[2];
         return Region{.outer = {{-y, -z},
                                 {y, -z},
                                 {y, -in},
                                 {web, -in},
                                 {web, in},
                                 {y, in},
                                 {y, z},
                                 {-y, z},
                                 {-y, in},
                                 {-web, in},
                                 {-web, -in},
                                 {-y, -in}}};
       }},
      {"box",
       {"height", "width", "flange_thickness", "web_thickness"},
       [](S s, double nu) {
         return section(Box{s[0], s[1], s[2], s[3]}, nu);
       },
       [](S s) {
         return section(Box{s[1], s[0], s[3], s[2]}, 0.0).second_moment;
       },
       [](S s, double nu) {
         return section(Box{s[1], s[0], s[3], s[2]}, nu).shear_coefficient;
       },
       nullptr,
       [](S s) { return s[0]; },
       [](S s) {
         return Region{.outer = middle(s[1], s[0]),
                       .holes = {middle(s[1] - 2.0 * s[3], s[0] - 2.0 * s[2])}};
       }}};
  return list;
}

const SectionShape* find_section_shape(std::string_view name) {
  const auto found = std::ranges::find(section_shapes(), name, &SectionShape::name);
  return found == section_shapes().end() ? nullptr : &*found;
}

}  // namespace wheeltap::fem
