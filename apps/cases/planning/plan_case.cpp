#include "apps/cases/planning/plan_case.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "apps/cases/beam_parameters.hpp"
#include "apps/cases/modal_data_case.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "apps/nearest.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/planning/added_mass.hpp"
#include "identification/structural/forward/assembled_model.hpp"

namespace wheeltap::apps {

using namespace identification;
using namespace identification::planning;

namespace {

constexpr std::size_t kMostCandidates = 500;

Pointer plan_key(const char* key) {
  return Pointer("/plan") / std::string(key);
}

double member_length(const CaseFile& file, const AnyStructure& structure, const Pointer& at) {
  const auto* members = std::get_if<fem::Structure>(&structure);
  if (members == nullptr) file.refuse(at / "every", "is allowed on members only");
  const fem::Mesh mesh(*members);
  double beam = 0.0;
  std::vector<std::string> names;
  for (std::size_t m = 0; m < members->members.size(); ++m) {
    const double length = mesh.member_length(static_cast<int>(m));
    if (members->members[m].name == file.json.at(at).value("member", "")) return length;
    names.push_back(members->members[m].name);
    beam += length;
  }
  if (file.json.contains("beam")) return beam;
  if (!file.json.at(at).contains("member"))
    file.refuse(at / "member", "is missing: \"every\" needs the name of a member");
  file.refuse(at / "member",
              "no member has this name" +
                  did_you_mean(file.json.at(at / "member").get<std::string>(), names));
}

/// The sensors of one entry of the list: a grid along a member, several nodes, or one sensor.
std::vector<Json> expand(const CaseFile& file, const AnyStructure& structure, const Pointer& at) {
  Json entry = file.json.at(at);
  for (const char* key : {"cost"}) entry.erase(key);
  if (entry.contains("every") + entry.contains("at") + entry.contains("nodes") +
          entry.contains("node") >
      1)
    file.refuse(at, "needs one of \"at\", \"every\", \"node\" and \"nodes\"");
  std::vector<Json> out;
  if (entry.contains("every")) {
    const double every = entry["every"].get<double>(), length = member_length(file, structure, at);
    entry.erase("every");
    if (!(every < length * (1.0 - 1e-9)))
      file.refuse(at / "every", "must be below the length, " + Json(length).dump() + " m");
    if (length / every > static_cast<double>(kMostCandidates))
      file.refuse(at / "every", "gives more than " + std::to_string(kMostCandidates) + " sensors");
    // Excludes the ends, because they are nodes or supports.
    for (int i = 1; i * every < length * (1.0 - 1e-9); ++i) {
      // 0.3, not 0.30000000000000004
      entry["at"] = std::stod(base::significant(i * every, 12));
      out.push_back(entry);
    }
    return out;
  }
  if (entry.contains("nodes")) {
    const Json nodes = entry["nodes"];
    entry.erase("nodes");
    for (const Json& node : nodes) {
      entry["node"] = node;
      out.push_back(entry);
    }
    return out;
  }
  return {entry};
}

/// The location of a sensor on the drawing of the structure.
std::optional<PlanCaseFile::Drawn> drawn_at(const AnyStructure& structure, const Json& sensor) {
  if (const auto* chain = std::get_if<fem::LumpedChain>(&structure)) {
    if (!sensor.contains("mass")) return {};
    const Json& mass = sensor["mass"];
    const double number =
        mass.is_string() ? std::atof(mass.get<std::string>().c_str()) : mass.get<double>();
    static_cast<void>(chain);
    return PlanCaseFile::Drawn{.at = {0.0, number, 0.0}, .direction = {1.0, 0.0, 0.0}};
  }
  const auto* members = std::get_if<fem::Structure>(&structure);
  if (members == nullptr) return {};
  PlanCaseFile::Drawn out;
  std::string along = sensor.value("direction", "y");
  const double sign = along.starts_with('-') ? -1.0 : 1.0;
  if (sign < 0.0) along.erase(0, 1);
  const std::size_t axis = along == "x" ? 0 : along == "z" ? 2 : 1;
  out.direction[axis] = sign;
  if (sensor.contains("node")) {
    for (const fem::Node& node : members->nodes)
      if (node.name == sensor["node"]) out.at = node.at;
    return out;
  }
  double left = sensor.value("at", 0.0);
  for (std::size_t m = 0; m < members->members.size(); ++m) {
    const fem::MemberFrame frame = fem::member_frame(*members, static_cast<int>(m));
    const bool named = sensor.contains("member");
    if (named ? members->members[m].name != sensor["member"]
              : left > frame.length && m + 1 < members->members.size()) {
      if (!named) left -= frame.length;
      continue;
    }
    const fem::Vector3& from = members->nodes[index(members->members[m].nodes[0])].at;
    for (std::size_t d = 0; d < 3; ++d) out.at[d] = from[d] + left * frame.axes[0][d];
    return out;
  }
  return out;
}

/// Removes the sensors of a grid at supports, which cannot move. Keeps at least one sensor.
template <class Parse>
void drop_fixed(std::vector<Json>& grid, const Parse& parse) {
  const auto fixed = [&](const Json& sensor) {
    try {
      static_cast<void>(parse(Json::array({sensor})));
      return false;
    } catch (const Failure&) {
      return true;
    }
  };
  std::vector<Json> moving;
  std::ranges::copy_if(grid, std::back_inserter(moving), std::not_fn(fixed));
  grid = moving.empty() ? std::vector<Json>{grid.front()} : std::move(moving);
}

void take_sensors(const CaseFile& file, const AnyStructure& structure, PlanCaseFile& out,
                  std::vector<double>& costs) {
  const Json& list = file.json.at(plan_key("sensors"));
  const auto parse = [&](const Json& sensors) {
    CaseFile only = file;
    only.json["plan"] = {{"sensors", sensors}};
    return parse_modal_data(only, Pointer("/plan"), structure).sensors;
  };
  // Parse each entry with one of its sensors, so that an error names the entry.
  Json first = list;
  std::vector<Json> all;
  bool own_costs = false;
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::vector<Json> some = expand(file, structure, plan_key("sensors") / i);
    if (list[i].contains("every")) drop_fixed(some, parse);
    first[i] = some.front();
    for (const Json& sensor : some) {
      all.push_back(sensor);
      costs.push_back(list[i].value("cost", -1.0));
    }
    own_costs = own_costs || list[i].contains("cost");
  }
  if (all.size() > kMostCandidates)
    file.refuse(plan_key("sensors"), "are " + std::to_string(all.size()) +
                                         " candidates: must be at most " +
                                         std::to_string(kMostCandidates));
  static_cast<void>(parse(first));
  out.plan.structure.candidates = parse(all);
  for (const Json& sensor : all) out.drawn.push_back(drawn_at(structure, sensor));
  out.sensors = std::move(all);
  const auto& names = out.plan.structure.candidates;
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (names[i].name == names[j].name)
        file.refuse(plan_key("sensors"), "name " + names[i].name + " twice");
  if (!own_costs) costs.clear();
}

void take_masses(const CaseFile& file, const AnyStructure& structure, PlanCaseFile& out) {
  if (!file.json.at("plan").contains("masses")) return;
  const Json& list = file.json.at(plan_key("masses"));
  const bool beam = file.json.contains("beam");
  const int rigid = out.plan.damage_case.rigid_body_modes;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Pointer at = plan_key("masses") / i;
    const double mass = list[i].at("mass").get<double>();
    const auto add = [&](std::string where, const auto& make) {
      try {
        AnyStructure made = make();
        try {
          const auto available = fem::mode_count(discretise(made));
          const int modes = std::min(rigid + out.plan.structure.modes, static_cast<int>(available));
          static_cast<void>(AssembledModel(made, out.plan.damage_case.kinds, modes, rigid));
        } catch (const fem::InvalidStructure& error) {
          file.refuse(at / "mass",
                      std::string("with this mass, the structure has no modes: ") + error.what());
        }
        out.plan.structure.masses.push_back(
            {.name = base::significant(mass, 4) + " kg at " + std::move(where),
             .structure = std::move(made)});
      } catch (const std::invalid_argument& error) {
        file.refuse(beam ? at / "at" : at, error.what());
      }
    };
    if (beam) {
      if (!list[i].contains("at")) file.refuse(at / "at", "is missing: metres from the left end");
      const double x = list[i]["at"].get<double>();
      add(base::significant(x, 4) + " m",
          [&] { return with_mass_on_beam(std::get<fem::Structure>(structure), x, mass); });
      continue;
    }
    if (!list[i].contains("node")) file.refuse(at / "node", "is missing: the name of a node");
    const auto name = list[i]["node"].get<std::string>();
    std::vector<std::string> names;
    if (const auto* members = std::get_if<fem::Structure>(&structure))
      for (const fem::Node& node : members->nodes) names.push_back(node.name);
    if (const auto* chain = std::get_if<fem::LumpedChain>(&structure))
      for (std::size_t m = 0; m < chain->masses.size(); ++m)
        names.push_back("mass " + std::to_string(m + 1));
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      file.refuse(at / "node", "no node has this name" + did_you_mean(name, names));
    add(name, [&] {
      return with_mass_at_node(structure, static_cast<int>(found - names.begin()), mass);
    });
  }
}

void take_noise(const CaseFile& file, PlanCase& plan) {
  const Json& p = file.json.at("plan");
  const bool law = p.contains("seconds") && p.contains("damping");
  if (p.contains("cov") && p.contains("damping"))
    file.refuse(plan_key("cov"), "give either \"cov\", or \"seconds\" and \"damping\"");
  if (!p.contains("cov") && !law)
    file.refuse(plan_key(p.contains("seconds") ? "damping" : "seconds"),
                "is missing: the noise of frequencies follows from \"seconds\" and \"damping\", or "
                "is given as \"cov\"");
  plan.noise = {.seconds = p.value("seconds", 600.0),
                .damping = p.value("damping", 0.01),
                .discrepancy = p.value("discrepancy", 0.0)};
  const auto take = [&p](const char* key, double& all, std::vector<double>& of_modes) {
    if (!p.contains(key)) return;
    if (p[key].is_array())
      of_modes = p[key].get<std::vector<double>>();
    else
      all = p[key].get<double>();
  };
  take("cov", plan.noise.cov, plan.noise.covs);
  take("shape_sd", plan.noise.shape_sd, plan.noise.shape_sds);
  plan.noise.reference_seconds = plan.noise.seconds;
  if (p.value("choose", 0) >= 2 && !p.contains("shape_sd"))
    file.refuse(plan_key("shape_sd"),
                "is missing: the standard deviation of the components of mode shapes (largest "
                "component 1)");
  if (p.contains("record_lengths")) {
    if (p.contains("cov"))
      file.refuse(plan_key("record_lengths"),
                  "need \"seconds\" and \"damping\" in place of \"cov\"");
    plan.record_lengths = p["record_lengths"].get<std::vector<double>>();
  }
}

/// The unknown coefficients, if the case has "parameters".
void take_unknowns(PlanCaseFile& out) {
  const CaseFile& f = out.parsed.file;
  if (!f.json.contains("parameters") || f.json["parameters"].empty()) return;
  if (f.json.at("plan").contains("masses"))
    f.refuse(plan_key("masses"),
             "need known coefficients: remove \"masses\", or replace the names of \"parameters\" "
             "by numbers");
  PlannedStructureOptions& structure = out.plan.structure;
  if (out.parsed.damage.structure) {
    structure.unknown = out.parsed.damage.structure;
    return;
  }
  const ParametricBeam beam = parse_parametric_beam(f);
  structure.unknown = beam.model;
  structure.uniform = beam.uniform;
}

void take_costs(const CaseFile& file, const std::vector<double>& of_sensors, PlanCase& plan) {
  const Json& p = file.json.at("plan");
  if (!p.contains("costs")) {
    if (!of_sensors.empty())
      file.refuse(plan_key("sensors"), "have a \"cost\": \"costs\" are missing");
    return;
  }
  const Json& c = p["costs"];
  TestCosts costs{.sensor = c.value("sensor", 0.0),
                  .of_sensors = of_sensors,
                  .hour = c.value("hour", 0.0),
                  .added_mass = c.value("added_mass", 0.0),
                  .inspection = c.at("inspection").get<double>(),
                  .missed = c.at("missed_damage").get<double>(),
                  .false_alarm = c.value("false_alarm", 0.0)};
  for (double& cost : costs.of_sensors)
    if (cost < 0.0) cost = costs.sensor;
  if (costs.hour > 0.0 && !p.contains("seconds"))
    file.refuse(plan_key("seconds"),
                "is missing: the cost of a test hour needs the length of the record");
  if (!(costs.missed > costs.inspection))
    file.refuse(plan_key("costs") / "missed_damage",
                "must exceed the cost of an inspection, " + Json(costs.inspection).dump() +
                    ": otherwise, no alarm justifies an inspection");
  plan.costs = std::move(costs);
}

void take_layouts(const CaseFile& file, PlanCase& plan) {
  const Json& p = file.json.at("plan");
  if (!p.contains("layouts")) return;
  const auto candidates = static_cast<int>(plan.structure.candidates.size());
  for (std::size_t i = 0; i < p["layouts"].size(); ++i) {
    std::vector<int> layout;
    for (std::size_t j = 0; j < p["layouts"][i].size(); ++j) {
      const int sensor = p["layouts"][i][j].get<int>();
      if (sensor < 0 || sensor >= candidates || std::ranges::find(layout, sensor) != layout.end())
        file.refuse(plan_key("layouts") / i / j, "must be the number of a candidate sensor, 0 to " +
                                                     std::to_string(candidates - 1) +
                                                     ", and occur once");
      layout.push_back(sensor);
    }
    std::ranges::sort(layout);
    plan.layouts.push_back(std::move(layout));
  }
}

void check_tolerance(const CaseFile& file, const PlanCase& plan) {
  const Json& p = file.json.at("plan");
  if (p.contains("band") && !(plan.structure.low_hz < plan.structure.high_hz))
    file.refuse(plan_key("band"), "must be [lowest, highest] frequency in Hz");
  const auto candidates = static_cast<int>(plan.structure.candidates.size());
  if (plan.choose > candidates)
    file.refuse(plan_key("choose"),
                "must be at most the number of candidate sensors, " + std::to_string(candidates));
  if (plan.choose == 1)
    file.refuse(plan_key("choose"),
                "one sensor cannot measure a mode shape, because shapes have no scale: choose 0 "
                "(frequencies alone) or at least 2");
}

}  // namespace

void PlanCaseFile::refuse(const InvalidInput& error) const {
  if (error.part() == InvalidInput::Part::data) parsed.file.refuse(plan_key("band"), error.what());
  if (error.part() == InvalidInput::Part::models)
    parsed.file.refuse(parsed.kinds.front() / "count", error.what());
  if (error.part() == InvalidInput::Part::location && parsed.damage.structure)
    parsed.file.refuse(parsed.kinds[index(error.index())] / "kind", error.what());
  parsed.refuse(error);
}

PlanCaseFile parse_plan_case(CaseFile file) {
  if (!file.json.is_object() || !file.json.contains("plan"))
    file.refuse(Pointer("/plan"),
                "is missing: an object with sensors, choose, modes, seconds, damping");
  for (const char* key : {"data", "baseline"}) file.json.erase(key);
  PlanCaseFile out{.parsed = parse_damage_case(std::move(file), Needs::structure), .plan = {}};
  const CaseFile& f = out.parsed.file;
  if (!f.json.contains("damage")) f.refuse(Pointer("/damage"), "is missing: must be an object");
  if (f.json.contains("predictor") && f.json["predictor"] != "fe")
    f.refuse(Pointer("/predictor"), "must be \"fe\" in a plan");
  const Json& p = f.json.at("plan");
  PlanCase& plan = out.plan;
  plan.damage_case = out.parsed.damage;
  // The checks of the case need data: set a placeholder frequency.
  plan.damage_case.data.frequencies_hz = {1.0};
  plan.damage_case.data.sd_hz = {1.0};
  explained(out.parsed, [&] {
    complete(plan.damage_case);
    return true;
  });
  take_unknowns(out);
  plan.structure.modes = p.value("modes", 10);
  if (p.contains("band")) {
    plan.structure.low_hz = p["band"][0].get<double>();
    plan.structure.high_hz = p["band"][1].get<double>();
  }
  plan.choose = p.value("choose", 0);
  plan.false_alarm = p.value("false_alarm", 0.05);
  AnyStructure structure;
  try {
    structure = plan.damage_case.solved_structure();
  } catch (const std::invalid_argument& error) {
    f.refuse(Pointer(out.parsed.damage.structure ? "/structure" : "/beam"), error.what());
  }
  std::vector<double> costs;
  if (p.contains("sensors")) take_sensors(f, structure, out, costs);
  take_masses(f, structure, out);
  take_noise(f, plan);
  take_costs(f, costs, plan);
  take_layouts(f, plan);
  plan.tolerance = p.value("tolerance", 0.05);
  check_tolerance(f, plan);
  return out;
}

}  // namespace wheeltap::apps
