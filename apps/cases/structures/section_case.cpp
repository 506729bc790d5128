#include "apps/cases/structures/section_case.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fem/sections/section_shapes.hpp"
#include "io/drawings/outline_file.hpp"
#ifdef WHEELTAP_WITH_CGAL
#include "fem/sections/section_mesh.hpp"
#endif

namespace wheeltap::apps {
namespace {

using Keys = std::vector<std::string>;

/// Keys of a section that has no "shape".
const Keys kPlain = {"area", "second_moment", "shear_coefficient"};

std::vector<double> sizes_of(const Json& s, const fem::SectionShape& shape) {
  std::vector<double> out;
  for (const std::string& key : shape.sizes) out.push_back(s.at(key).get<double>());
  return out;
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
                "the file states its unit, " + Json(drawing.unit).dump() + " m; remove this key");
  std::vector<fem::Ring> rings;
  for (const io::ClosedPath& path : drawing.outlines) rings.push_back(ring_of(path, unit));
  return fem::nested(rings);
}

/// Throws Failure for an error of fem::checked, with its location: "/beam/section/outline/3".
[[noreturn]] void refuse_outline(const CaseFile& file, const Pointer& where, const Json& s,
                                 std::size_t main_regions, const fem::OutlineError& error) {
  using Part = fem::OutlinePlace::Part;
  if (s.contains("file") || s.value("shape", "") != "polygon") file.refuse(where, error.what());
  const fem::OutlinePlace& place = error.place;
  Pointer at = where;
  if (place.region >= main_regions) at = at / "regions" / (place.region - main_regions);
  if (place.part == Part::outer) at = at / "outline";
  if (place.part == Part::hole) at = at / "holes" / place.hole;
  if (place.part == Part::modulus) at = at / "modulus";
  if (place.part == Part::poisson) at = at / "poisson";
  if (place.part == Part::density) at = at / "density";
  if (place.corner) at = at / *place.corner;
  file.refuse(at, error.reason);
}

void check_polygon(const CaseFile& file, const Pointer& where) {
  const Json& s = file.json.at(where);
  static const Keys known = {"shape", "outline",          "holes", "file", "regions",
                             "unit",  "shear_coefficient"};
  for (const auto& [key, ignored] : s.items())
    if (std::ranges::find(known, key) == known.end())
      file.refuse(
          where / key,
          "is not a key of a \"polygon\" section, which has outline or file, holes, regions");
  const bool outline = s.contains("outline"), named = s.contains("file");
  if (!outline && !named && !s.contains("regions"))
    file.refuse(where / "outline",
                "is missing: a \"polygon\" section needs outline, file or regions");
  if (outline && named)
    file.refuse(where / "file", "replaces \"outline\": give only one of the two keys");
  if (!outline && s.contains("holes"))
    file.refuse(where / "holes", "are allowed with outline only; a file contains its holes");
  if (!named && s.contains("unit")) file.refuse(where / "unit", "is allowed with file only");
}

}  // namespace

void check_sizes(const CaseFile& file, const Pointer& where) {
  const Json& s = file.json.at(where);
  const auto shape = s.value("shape", std::string());
  if (shape == "polygon") return check_polygon(file, where);
  const fem::SectionShape* const known = fem::find_section_shape(shape);
  const Keys& sizes = known != nullptr ? known->sizes : kPlain;
  std::string list;
  for (const auto& size : sizes) list += (list.empty() ? "" : ", ") + size;
  const std::string what =
      shape.empty() ? "a section without a shape" : "a \"" + shape + "\" section";
  for (const auto& size : sizes) {
    if (!s.contains(size))
      file.refuse(where / size, "is missing: " + what + " has " + list + "; write \"" + size +
                                    (shape.empty() ? "\" with its value in SI units"
                                                   : "\": 0.01 with the dimension in metres"));
  }
  for (const auto& [key, ignored] : s.items()) {
    if (key != "shape" && key != "shear_coefficient" &&
        std::ranges::find(sizes, key) == sizes.end()) {
      file.refuse(where / key, "is not a dimension of " + what + ", which has " + list);
    }
  }
}

fem::Section parse_sized_section(const CaseFile& file, const Pointer& where, double poisson) {
  const Json& s = file.json.at(where);
  try {
    if (const fem::SectionShape* shape = fem::find_section_shape(s.value("shape", "")))
      return shape->plane(sizes_of(s, *shape), poisson);
    const auto size = [&](const std::string& key) { return s.at(key).get<double>(); };
    return {size(kPlain[0]), size(kPlain[1]), size(kPlain[2])};
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
    const fem::SectionShape& shape = *fem::find_section_shape(s.at("shape").get<std::string>());
    fem::Region region = shape.outline(sizes_of(s, shape));
    region.poisson = material.poisson;
    return {{std::move(region)}};
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
        file.refuse(at / "modulus", "replaces \"young\": give only one of the two keys");
      if (!material.young)
        file.refuse(at / "young",
                    "needs a reference value: give young in the case, or modulus here");
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
  } catch (const fem::OutlineError& error) {
    refuse_outline(file, where, s, own, error);
  } catch (const std::invalid_argument& error) {
    file.refuse(where, error.what());
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
    file.refuse(
        where,
        "the properties of the section are not finite numbers, because the outline has details too "
        "small for its "
        "size. Remove coincident corners and parts thinner than a millionth of the section");
  return result;
#else
  file.refuse(where,
              "outlines need CGAL, but this program was built without it (WHEELTAP_WITH_CGAL=ON)");
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
                  "the shear coefficient of the section did not converge: remove unimportant "
                  "details of the "
                  "outline (see wheeltap section)");
    // The shear stiffness κ G A uses G of the reference material and the weighted A.
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
