#include "apps/runs/found_structure_modes.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "apps/cases/damage_case.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "apps/cases/update_case.hpp"
#include "apps/report_json.hpp"
#include "apps/results/structure_drawing.hpp"
#include "apps/runs/running.hpp"
#include "apps/words.hpp"
#include "identification/structural/structure_plausibility.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

constexpr int kUsualModes = 10;

DrawnStructure build(const CaseFile& file, const AnyStructure& structure) {
  try {
    return drawn(structure);
  } catch (const fem::InvalidStructure& error) {
    refuse_structure(file, structure, error);
  }
}

fem::StructureModes solve(const CaseFile& file, const DrawnStructure& structure, int wanted) {
  try {
    return fem::structure_modes(structure.discretisation, wanted);
  } catch (const std::invalid_argument& error) {
    file.refuse(Pointer("/structure"), error.what());
  }
}

Report shapes_of(const DrawnStructure& structure, const fem::StructureModes& modes) {
  Report shapes = Report::array();
  for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
    Report shape = Report::object();
    for (const NodeMotion& node : node_motions(structure.drawing, modes.shapes.col(j))) {
      Report motions = Report::object();
      for (const auto& [direction, value] : node.motions) motions[direction] = value;
      shape[node.node] = std::move(motions);
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace

FoundModes find_structure_modes(CaseFile file, const ModesOptions& options) {
  const bool update = file.json.value("kind", Json()) == "update";
  // `wheeltap modes` does not need data or parameters.
  validate_against_schema(file,
                          update && file.json.contains("parameters") ? "update" : "structure");
  std::vector<std::string> remarks;
  const StructureModel model = parse_structure(file, &remarks);
  DrawnStructure structure = build(file, model.nominal);
  if (options.truth && update) {
    const UpdateCaseFile parsed = parse_update_case(file, UpdateNeeds::structure);
    if (!parsed.update.simulation) file.refuse(Pointer("/truth"), "is missing: --truth needs it");
    structure = build(file, model.at(parsed.update.simulation->parameters));
  } else if (options.truth) {
    const DamageCaseFile parsed = parse_damage_case(file, Needs::structure);
    if (!parsed.damage.simulation)
      file.refuse(Pointer("/damage/truth"), "is missing: --truth needs it");
    structure.discretisation = explained(parsed, [&] { return true_structure(parsed.damage); });
  }
  const auto rigid = static_cast<int>(structure.discretisation.rigid_motions.cols());
  const auto there = static_cast<int>(fem::mode_count(structure.discretisation));
  if (there == 0) file.refuse(Pointer("/structure"), "has no free degree of freedom with mass");
  const int wanted = options.modes.value_or(std::min(kUsualModes + rigid, there));
  const fem::StructureModes modes = solve(file, structure, wanted);
  const std::string title = file.json.value("title", file.path.stem().string());
  if (!options.vtk.empty()) {
    if (structure.drawing.points.empty())
      throw Failure(Exit::usage, "--vtk: matrices have no coordinates, so nothing can be drawn");
    write_text(options.vtk, vtk_text(structure.drawing, modes, title));
  }
  const std::vector<double> frequencies(modes.frequencies_hz.begin(), modes.frequencies_hz.end());
  Report report = {{"frequencies_hz", frequencies},
                   {"rigid_body_modes", modes.rigid_body_modes},
                   {"certified", modes.certified},
                   {"solver", modes.solver},
                   {"degrees_of_freedom", structure.discretisation.size()}};
  Report largest = Report::array();
  for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j)
    largest.push_back(largest_motion(structure.drawing, modes.shapes.col(j)));
  report["largest_motion"] = largest;
  if (!model.parameters.empty() && !(options.truth && update)) {
    Report parameters = Report::object();
    for (const auto& parameter : model.parameters)
      parameters[parameter.name] = parameter.prior.from_standard_normal(0.0);
    report["parameters"] = parameters;
  }
  if (options.shapes) report["shapes"] = shapes_of(structure, modes);
  std::ostringstream text;
  text << title
       << (!options.truth ? " (intact; "
           : update       ? " (in truth; "
                          : " (as damaged in truth; ")
       << structure.discretisation.size() << " degrees of freedom)\n";
  for (const auto& parameter : model.parameters) {
    if (options.truth && update) break;
    text << (&parameter == &model.parameters.front() ? "at the priors' medians: " : ", ")
         << parameter.name << " = " << significant(parameter.prior.from_standard_normal(0.0), 5);
  }
  if (!model.parameters.empty() && !(options.truth && update)) text << '\n';
  text << "\n  mode   frequency [Hz]   largest motion\n";
  for (Eigen::Index j = 0; j < modes.shapes.cols(); ++j) {
    char line[64];
    std::snprintf(line, sizeof line, "  %4d   %14.6f   ", static_cast<int>(j) + 1,
                  frequencies[static_cast<std::size_t>(j)]);
    text << line << largest_motion(structure.drawing, modes.shapes.col(j))
         << (j < modes.rigid_body_modes ? "  (rigid body)" : "") << '\n';
  }
  text << (modes.certified ? "\nCertified: no mode below the last listed mode is missing.\n"
                           : "\nNot certified: a mode may be missing.\n");
  for (const std::string& remark : remarks) text << "Note: " << remark << ".\n";
  return {.report = std::move(report), .text = text.str(), .doubts = implausible(model.nominal)};
}

}  // namespace wheeltap::apps
