#include "apps/cases/beam_case.hpp"

#include <string>
#include <vector>

#include "apps/cases/structures/section_case.hpp"

namespace wheeltap::apps {
namespace {

std::string beam_number(double x) {
  return Json(x).dump();
}

Pointer beam_key(const char* text) {
  return Pointer(text);
}

std::vector<fem::Support> parse_supports(const CaseFile& file, double length) {
  const Pointer where = beam_key("/beam/supports");
  const Json& supports = file.json.at(where);
  if (supports.is_string()) return fem::named_supports(supports.get<std::string>(), length);
  std::vector<fem::Support> list;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const Json& s = supports[i];
    fem::Support support{
        .at = s.at("at").get<double>(), .deflection = false, .rotation = false, .stiffness = {}};
    if (support.at > length) {
      file.refuse(where / i / "at",
                  "is outside the beam, which is " + beam_number(length) + " m long");
    }
    for (const auto& motion : s.at("fix")) {
      (motion == "deflection" ? support.deflection : support.rotation) = true;
    }
    if (s.contains("stiffness") && s["stiffness"].is_number())
      support.stiffness = s["stiffness"].get<double>();
    list.push_back(support);
  }
  return list;
}

}  // namespace

fem::Beam parse_beam(const CaseFile& file) {
  const Json& b = file.json.at("beam");
  const Json& m = b.at("material");
  const double length = b.at("length").get<double>();
  fem::Material material{m.at("young").get<double>(), m.at("poisson").get<double>(),
                         m.at("density").get<double>()};
  const BeamSection section = parse_beam_section(file, beam_key("/beam/section"), material);
  material.density = section.density;
  fem::Beam beam{.length = length,
                 .elements = b.at("elements").get<int>(),
                 .supports = parse_supports(file, length),
                 .material = material,
                 .section = section.section};
  try {
    fem::validate(beam);
  } catch (const std::invalid_argument& error) {
    file.refuse(beam_key("/beam"), error.what());
  }
  return beam;
}

}  // namespace wheeltap::apps
