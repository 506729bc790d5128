#include "apps/cases/beam_parameters.hpp"

#include "apps/cases/beam_case.hpp"
#include "apps/cases/states_case.hpp"
#include "apps/cases/structures/structure_parameters.hpp"

namespace wheeltap::apps {

using identification::AnyStructure;
using identification::StructureModel;

ParametricBeam parse_parametric_beam(const CaseFile& file) {
  const Pointer beam("/beam"), material = beam / "material", supports = beam / "supports";
  StructureParameters parameters(file);
  CaseFile medians = file;
  const auto coefficient = [&](const Pointer& where, const Bounds& bounds) {
    const Coefficient found = parameters.coefficient(where, bounds);
    medians.json[where] = found.nominal;
    return found;
  };
  const Coefficient young = coefficient(material / "young", kPositive);
  const Coefficient density = coefficient(material / "density", kPositive);
  const bool regions = file.json.at(beam).at("section").contains("regions");
  if (regions && !(young.known() && density.known()))
    file.refuse(material, "young and density must be numbers for a section with \"regions\"");
  ParametricBeam out;
  std::vector<std::pair<std::size_t, Coefficient>> springs;
  const Json& list = file.json.at(supports);
  for (std::size_t i = 0; list.is_array() && i < list.size(); ++i) {
    if (!list[i].contains("stiffness") || list[i]["stiffness"] == "rigid") continue;
    springs.emplace_back(i, coefficient(supports / i / "stiffness", kPositive));
    if (!springs.back().second.known()) out.uniform = false;
  }
  out.beam = parse_beam(medians);
  const Json& section = file.json.at(beam).at("section");
  for (const char* height : {"height", "diameter", "outer_diameter"})
    if (section.contains(height)) out.depth = section[height].get<double>();

  if (!has_states(file)) return out;
  const auto for_pieces = [](AnyStructure& any, auto&& set) {
    for (fem::Member& member : std::get<fem::Structure>(any).members)
      for (fem::Member::Piece& piece : member.pieces) set(piece);
  };
  parameters.follow(young, [=](AnyStructure& s, double x) {
    for_pieces(s, [x](fem::Member::Piece& piece) { piece.material.young = x; });
  });
  parameters.follow(density, [=](AnyStructure& s, double x) {
    for_pieces(s, [x](fem::Member::Piece& piece) { piece.material.density = x; });
  });
  // as_structure keeps the order of the beam's supports, so that indices remain valid.
  for (const auto& [index, spring] : springs)
    parameters.follow(spring, [i = index](AnyStructure& s, double x) {
      for (double& k : std::get<fem::Structure>(s).supports[i].stiffness)
        if (k > 0.0) k = x;
    });
  try {
    out.model = std::make_shared<const StructureModel>(
        std::move(parameters).model(fem::as_structure(out.beam, out.depth)));
  } catch (const std::invalid_argument& error) {
    file.refuse(beam, error.what());
  }
  return out;
}

}  // namespace wheeltap::apps
