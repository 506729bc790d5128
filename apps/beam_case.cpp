#include "apps/beam_case.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "apps/section_case.hpp"

namespace wheeltap::apps {
namespace {

std::string number(double x) {
  return Json(x).dump();
}

Pointer at(const char* text) {
  return Pointer(text);
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
  fem::Material material{m.at("young"), m.at("poisson"), m.at("density")};
  const BeamSection section = parse_beam_section(file, at("/beam/section"), material);
  material.density = section.density;
  fem::Beam beam{.length = length,
                 .elements = b.at("elements").get<int>(),
                 .supports = parse_supports(file, length),
                 .material = material,
                 .section = section.section};
  try {
    fem::validate(beam);
  } catch (const std::invalid_argument& error) {
    file.refuse(at("/beam"), error.what());
  }
  return beam;
}

}  // namespace wheeltap::apps
