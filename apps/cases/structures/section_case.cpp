#include "apps/cases/structures/section_case.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fem/sections/section.hpp"
#include "io/drawings/outline_file.hpp"
#ifdef WHEELTAP_WITH_CGAL
#include "fem/sections/section_mesh.hpp"
#endif

namespace wheeltap::apps {
namespace {

using Keys = std::vector<std::string>;

/// The keys of each shape; those of a polygon are checked on their own.
const std::vector<std::pair<std::string, Keys>>& section_shapes() {
  static const std::vector<std::pair<std::string, Keys>> list = {
      {"rectangle", {"width", "height"}},
      {"circle", {"diameter"}},
      {"tube", {"outer_diameter", "thickness"}},
      {"i", {"height", "width", "flange_thickness", "web_thickness"}},
      {"box", {"height", "width", "flange_thickness", "web_thickness"}},
      {"", {"area", "second_moment", "shear_coefficient"}}};
  return list;
}

fem::Ring parse_ring(const Json& list) {
  fem::Ring ring;
  for (const Json& corner : list)
    ring.emplace_back(corner[0].get<double>(), corner[1].get<double>());
  return ring;
}

std::vector<fem::Ring> parse_rings(const Json& lists) {
  std::vector<fem::Ring> rings;
  for (const Json& list : lists) rings.push_back(parse_ring(list));
  return rings;
}

fem::Ring ring_of(const io::ClosedPath& path, double unit) {
  fem::Ring ring;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const io::PathCorner &a = path[i], &b = path[(i + 1) % path.size()];
    const Eigen::Vector2d from = unit * Eigen::Vector2d(a.x, a.y),
                          to = unit * Eigen::Vector2d(b.x, b.y);
    if (a.bulge == 0.0 || from == to) {
      ring.push_back(from);
    } else {
      const fem::Ring edge = fem::arc(from, to, 4.0 * std::atan(a.bulge));
      ring.insert(ring.end(), edge.begin(), edge.end());
    }
  }
  return ring;
}

std::vector<fem::Region> regions_of_file(const CaseFile& file, const Pointer& where) {
  const Json& s = file.json.at(where);
  const io::Drawing drawing = io::read_outlines(file.resolve(s.at("file").get<std::string>()));
  const double unit = drawing.unit > 0.0 ? drawing.unit : io::metres(s.value("unit", "m"));
  if (drawing.unit > 0.0 && s.contains("unit") &&
      io::metres(s.at("unit").get<std::string>()) != drawing.unit)
    file.refuse(where / "unit",
                "the file says that a unit is " + Json(drawing.unit).dump() + " m; leave this out");
  std::vector<fem::Ring> rings;
  for (const io::ClosedPath& path : drawing.outlines) rings.push_back(ring_of(path, unit));
  return fem::nested(rings);
}

/// fem::checked's places as the case writes them: "/beam/section/outline/3".
[[noreturn]] void refuse_outline(const CaseFile& file, const Pointer& where, const Json& s,
                                 std::size_t main_regions, const std::string& message) {
  const auto colon = message.find(": ");
  if (!message.starts_with("regions[") || colon == std::string::npos) file.refuse(where, message);
  const std::string what = message.substr(colon + 2);
  if (s.contains("file") || !s.contains("shape") || s.at("shape") != "polygon")
    file.refuse(where, message);
  std::string path = message.substr(8, colon - 8);  // "0].holes[1][4]"
  for (const std::string& drop : {std::string("]")})
    for (auto at = path.find(drop); at != std::string::npos; at = path.find(drop))
      path.erase(at, drop.size());
  std::ranges::replace(path, '.', '/');
  std::ranges::replace(path, '[', '/');
  const auto slash = path.find('/');
  const auto region = static_cast<std::size_t>(std::stoul(path.substr(0, slash)));
  std::string rest = slash == std::string::npos ? "" : path.substr(slash);
  if (const auto outer = rest.find("/outer"); outer != std::string::npos)
    rest.replace(outer, 6, "/outline");
  if (region < main_regions) file.refuse(Pointer(where.to_string() + rest), what);
  const Pointer place(where.to_string() + "/regions/" + std::to_string(region - main_regions) +
                      rest);
  file.refuse(place, what);
}

void check_polygon(const CaseFile& file, const Pointer& where) {
  const Json& s = file.json.at(where);
  static const Keys known = {"shape", "outline",          "holes", "file", "regions",
                             "unit",  "shear_coefficient"};
  for (const auto& [key, ignored] : s.items())
    if (std::ranges::find(known, key) == known.end())
      file.refuse(where / key,
                  "a \"polygon\" section has no such size; it has outline or file, holes, regions");
  const bool outline = s.contains("outline"), named = s.contains("file");
  if (!outline && !named && !s.contains("regions"))
    file.refuse(where / "outline",
                "is missing: a \"polygon\" section has outline, file or regions");
  if (outline && named) file.refuse(where / "file", "takes the place of outline: give one of them");
  if (!outline && s.contains("holes"))
    file.refuse(where / "holes", "go with outline; those of a file stand in the file");
  if (!named && s.contains("unit")) file.refuse(where / "unit", "goes with file only");
}

fem::Outline sized_outline(const Json& s, double poisson) {
  const auto size = [&](const char* key) { return s.at(key).get<double>(); };
  const auto middle = [](double width, double height) -> fem::Ring {
    const double y = 0.5 * width, z = 0.5 * height;
    return {{-y, -z}, {y, -z}, {y, z}, {-y, z}};
  };
  const std::string shape = s.at("shape").get<std::string>();
  fem::Region region{.outer = {}, .poisson = poisson};
  if (shape == "circle") {
    region.outer = fem::circle({0, 0}, 0.5 * size("diameter"));
  } else if (shape == "tube") {
    const double radius = 0.5 * size("outer_diameter");
    region.outer = fem::circle({0, 0}, radius);
    region.holes = {fem::circle({0, 0}, radius - size("thickness"))};
  } else {
    const double w = size("width"), h = size("height");
    region.outer = middle(w, h);
    if (shape == "box")
      region.holes = {middle(w - 2.0 * size("web_thickness"), h - 2.0 * size("flange_thickness"))};
    if (shape == "i") {
      const double y = 0.5 * w, z = 0.5 * h, web = 0.5 * size("web_thickness"),
                   in = z - size("flange_thickness");
      region.outer = {{-y, -z}, {y, -z}, {y, -in}, {web, -in}, {web, in},   {y, in},
                      {y, z},   {-y, z}, {-y, in}, {-web, in}, {-web, -in}, {-y, -in}};
    }
  }
  return {{region}};
}

}  // namespace

void check_sizes(const CaseFile& file, const Pointer& where) {
  const Json& s = file.json.at(where);
  const auto shape = s.value("shape", std::string());
  if (shape == "polygon") return check_polygon(file, where);
  const Keys& sizes =
      std::ranges::find(section_shapes(), shape, &std::pair<std::string, Keys>::first)->second;
  std::string list;
  for (const auto& size : sizes) list += (list.empty() ? "" : ", ") + size;
  const std::string what =
      shape.empty() ? "a section without a shape" : "a \"" + shape + "\" section";
  for (const auto& size : sizes) {
    if (!s.contains(size))
      file.refuse(where / size, "is missing: " + what + " has " + list + "; write \"" + size +
                                    (shape.empty() ? "\" with its value in SI units"
                                                   : "\": 0.01 with the size in metres"));
  }
  for (const auto& [key, ignored] : s.items()) {
    if (key != "shape" && key != "shear_coefficient" &&
        std::ranges::find(sizes, key) == sizes.end()) {
      file.refuse(where / key, what + " has no such size; it has " + list);
    }
  }
}

fem::Section parse_sized_section(const CaseFile& file, const Pointer& where, double poisson) {
  const Json& s = file.json.at(where);
  const auto shape = s.value("shape", std::string());
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
    return section;
  } catch (const std::invalid_argument& error) {
    file.refuse(where, error.what());
  }
}

fem::Outline parse_outline(const CaseFile& file, const Pointer& where,
                           const SectionMaterial& material) {
  check_sizes(file, where);
  const Json& s = file.json.at(where);
  if (s.value("shape", "") != "polygon") {
    (void)parse_sized_section(file, where, std::min(material.poisson, 0.49));
    return sized_outline(s, material.poisson);
  }
  fem::Outline outline;
  if (s.contains("file")) outline.regions = regions_of_file(file, where);
  if (s.contains("outline"))
    outline.regions.push_back({.outer = parse_ring(s.at("outline")),
                               .holes = parse_rings(s.value("holes", Json::array()))});
  for (fem::Region& region : outline.regions) {
    region.poisson = material.poisson;
    region.density = material.density.value_or(1.0);
  }
  const Json parts = s.value("regions", Json::array());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Json& part = parts[i];
    const Pointer at = where / "regions" / i;
    double modulus = part.value("modulus", 1.0);
    if (part.contains("young")) {
      if (part.contains("modulus"))
        file.refuse(at / "modulus", "says the same as young: give one of them");
      if (!material.young)
        file.refuse(at / "young",
                    "has nothing to relate to: give the case's young, or modulus here");
      modulus = part.at("young").get<double>() / *material.young;
    }
    outline.regions.push_back({.outer = parse_ring(part.at("outline")),
                               .holes = parse_rings(part.value("holes", Json::array())),
                               .modulus = modulus,
                               .poisson = part.value("poisson", material.poisson),
                               .density = part.value("density", material.density.value_or(1.0))});
  }
  const std::size_t own = outline.regions.size() - parts.size();
  try {
    return fem::checked(outline);
  } catch (const std::invalid_argument& error) {
    refuse_outline(file, where, s, own, error.what());
  }
}

MeshedSection analyse(const CaseFile& file, const Pointer& where, const SectionMaterial& material) {
  MeshedSection result{.outline = parse_outline(file, where, material), .mesh = {}, .analysis = {}};
#ifdef WHEELTAP_WITH_CGAL
  try {
    result.mesh = fem::section_mesh(result.outline);
    result.analysis = fem::analyse_section(result.mesh, result.outline.regions,
                                           {.reference_poisson = material.poisson});
  } catch (const std::invalid_argument& error) {
    file.refuse(where, error.what());
  }
  if (!result.analysis.finite())
    file.refuse(where,
                "its figures are not finite numbers: the outline has details that are lost beside "
                "its size. Leave out corners that lie on each other and parts thinner than a "
                "millionth of the section");
  return result;
#else
  file.refuse(where,
              "outlines need CGAL, and this program was built without it (WHEELTAP_WITH_CGAL=ON)");
#endif
}

BeamSection parse_beam_section(const CaseFile& file, const Pointer& where,
                               const fem::Material& material) {
  check_sizes(file, where);
  const Json& s = file.json.at(where);
  BeamSection beam{.section = {}, .density = material.density};
  if (s.value("shape", "") == "polygon") {
    const auto meshed = analyse(
        file, where,
        {.poisson = material.poisson, .young = material.young, .density = material.density});
    const fem::SectionProperties& p = meshed.analysis.properties;
    if (!(meshed.analysis.errors.shear_flexibility <= 1e-3))
      file.refuse(where,
                  "its shear coefficient did not settle: leave out details of the outline "
                  "that do not matter (see wheeltap section)");
    // The shear stiffness κ G A has the reference's G and the weighted A.
    beam.section = {.area = p.area,
                    .second_moment = p.second_moments.yy,
                    .shear_coefficient = p.shear_area / p.area / p.shear_flexibility.zz};
    beam.density = p.mass_per_length / p.area;
  } else {
    beam.section = parse_sized_section(file, where, material.poisson);
  }
  if (s.contains("shear_coefficient"))
    beam.section.shear_coefficient = s.at("shear_coefficient").get<double>();
  return beam;
}

}  // namespace wheeltap::apps
