#include "apps/beam_case.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "fem/section.hpp"

namespace wheeltap::apps {
namespace {

std::string number(double x) {
  return Json(x).dump();
}

Pointer at(const char* text) {
  return Pointer(text);
}

fem::Section parse_section(const CaseFile& file, double poisson) {
  const Pointer where = at("/beam/section");
  const Json& s = file.json.at(where);
  static const std::vector<std::pair<std::string, std::vector<std::string>>> shapes = {
      {"rectangle", {"width", "height"}},
      {"circle", {"diameter"}},
      {"tube", {"outer_diameter", "thickness"}},
      {"i", {"height", "width", "flange_thickness", "web_thickness"}},
      {"box", {"height", "width", "flange_thickness", "web_thickness"}},
      {"", {"area", "second_moment", "shear_coefficient"}}};
  const auto shape = s.value("shape", std::string());
  const auto& sizes =
      std::ranges::find(shapes, shape, &std::pair<std::string, std::vector<std::string>>::first)
          ->second;
  std::string list;
  for (const auto& size : sizes) list += (list.empty() ? "" : ", ") + size;
  const std::string what =
      shape.empty() ? "a section without a shape" : "a \"" + shape + "\" section";
  for (const auto& size : sizes) {
    if (!s.contains(size)) file.refuse(where / size, "is missing: " + what + " has " + list);
  }
  for (const auto& [key, ignored] : s.items()) {
    if (key != "shape" && key != "shear_coefficient" &&
        std::ranges::find(sizes, key) == sizes.end()) {
      file.refuse(where / key, what + " has no such size; it has " + list);
    }
  }
  const auto size = [&](const char* key) { return s.at(key).get<double>(); };
  try {
    fem::Section section{};
    if (shape == "rectangle") {
      section = fem::section(fem::Rectangle{size("width"), size("height")}, poisson);
    } else if (shape == "circle") {
      section = fem::section(fem::Circle{size("diameter")}, poisson);
    } else if (shape == "tube") {
      section = fem::section(fem::Tube{size("outer_diameter"), size("thickness")}, poisson);
    } else if (shape == "i") {
      section = fem::section(fem::ISection{size("height"), size("width"), size("flange_thickness"),
                                           size("web_thickness")},
                             poisson);
    } else if (shape == "box") {
      section = fem::section(
          fem::Box{size("height"), size("width"), size("flange_thickness"), size("web_thickness")},
          poisson);
    } else {
      section = {size("area"), size("second_moment"), size("shear_coefficient")};
    }
    if (s.contains("shear_coefficient")) section.shear_coefficient = size("shear_coefficient");
    return section;
  } catch (const std::invalid_argument& error) {
    file.refuse(where, error.what());
  }
}

std::vector<fem::Support> parse_supports(const CaseFile& file, double length) {
  const Pointer where = at("/beam/supports");
  const Json& supports = file.json.at(where);
  if (supports.is_string()) return fem::named_supports(supports.get<std::string>(), length);
  std::vector<fem::Support> list;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const Json& s = supports[i];
    fem::Support support{.at = s.at("at"), .deflection = false, .rotation = false, .stiffness = {}};
    if (support.at > length) {
      file.refuse(where / i / "at",
                  "lies outside the beam, which is " + number(length) + " m long");
    }
    for (const auto& motion : s.at("fix")) {
      (motion == "deflection" ? support.deflection : support.rotation) = true;
    }
    if (s.contains("stiffness") && s["stiffness"].is_number()) support.stiffness = s["stiffness"];
    list.push_back(support);
  }
  return list;
}

}  // namespace

fem::Beam parse_beam(const CaseFile& file) {
  const Json& b = file.json.at("beam");
  const Json& m = b.at("material");
  const double length = b.at("length");
  const fem::Material material{m.at("young"), m.at("poisson"), m.at("density")};
  fem::Beam beam{.length = length,
                 .elements = b.at("elements").get<int>(),
                 .supports = parse_supports(file, length),
                 .material = material,
                 .section = parse_section(file, material.poisson)};
  try {
    fem::validate(beam);
  } catch (const std::invalid_argument& error) {
    file.refuse(at("/beam"), error.what());
  }
  return beam;
}

}  // namespace wheeltap::apps
