#include "apps/results/planning/plan_summary.hpp"

#include <algorithm>
#include <cmath>

#include "apps/structure_words.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "fem/structures/mesh.hpp"
#include "fem/structures/structure_drawing.hpp"

namespace wheeltap::apps {

using namespace identification;
using namespace identification::planning;

namespace {

Report estimate_of(const TestScores& scores) {
  return {{"information", compact(scores.information.mcse)},
          {"detection", compact(scores.detection.mcse)},
          {"right_place", compact(scores.right_place.mcse)}};
}

Report design_report(const PlanCaseFile& parsed, const ScoredDesign& d) {
  Report names = Report::array();
  for (const int s : d.design.sensors)
    names.push_back(parsed.plan.structure.candidates[index(s)].name);
  Report out = {{"name", d.name},
                {"sensors", d.design.sensors},
                {"sensor_names", names},
                {"seconds", d.seconds},
                {"modes", d.modes},
                {"information", compact(d.scores.information.value)},
                {"detection", compact(d.scores.detection.value)},
                {"right_place", compact(d.scores.right_place.value)},
                {"mcse", estimate_of(d.scores)},
                {"threshold", compact(d.scores.threshold)}};
  if (d.design.mass >= 0)
    out["added_mass"] = parsed.plan.structure.masses[index(d.design.mass)].name;
  return out;
}

Report designs_report(const PlanCaseFile& parsed, const std::vector<ScoredDesign>& list) {
  Report out = Report::array();
  for (const ScoredDesign& d : list) out.push_back(design_report(parsed, d));
  return out;
}

Report optional_number(const std::optional<double>& x) {
  return x ? Report(compact(*x)) : Report(nullptr);
}

/// Site and location, in the terms of the case.
Report place_report(const PlannedStructure& structure, const TestPlace& place) {
  const DefectKind& kind = structure.kinds()[index(place.kind)];
  Report out = {{"place", place.name}, {"kind", kind.name}};
  const SiteLine::Stretch& stretch = kind.line.stretches()[index(place.stretch)];
  if (!kind.line.is_beam()) out[kind.site_name()] = stretch.name;
  if (stretch.size > 0.0) out["location"] = compact(0.5 * (place.start + place.end));
  return out;
}

Report separation_report(const PlanCaseFile& parsed, const std::optional<Separation>& s) {
  if (!s) return nullptr;
  Report out = {{"separated", s->separated}, {"of", s->of}};
  if (s->mass >= 0) {
    out["mass"] = parsed.plan.structure.masses[index(s->mass)].name;
    return out;
  }
  Report names = Report::array();
  for (const int c : s->sensors) names.push_back(parsed.plan.structure.candidates[index(c)].name);
  out["sensors"] = s->sensors;
  out["sensor_names"] = names;
  return out;
}

Report confusion_report(const Confusion& confusion) {
  Report out = Report::array();
  for (const ConfusedRegions& r : confusion.regions)
    out.push_back({{"first", r.first.name},
                   {"second", r.second.name},
                   {"pairs", r.pairs},
                   {"exact", r.exact}});
  return out;
}

Report resolution_report(const Confusion& confusion) {
  Report out = Report::array();
  for (const PlaceResolution& r : confusion.resolutions)
    out.push_back({{"member", r.name}, {"metres", compact(r.metres)}});
  return out;
}

/// The coordinates of a location on the drawing: [x, y, z]; null without a drawing.
Report drawn_place(const AnyStructure& structure, const DefectKind& kind, const TestPlace& place) {
  const SiteLine::Stretch& stretch = kind.line.stretches()[index(place.stretch)];
  if (std::holds_alternative<fem::LumpedChain>(structure)) {
    const auto& chain = std::get<fem::LumpedChain>(structure);
    if (kind.type->sites != DefectType::Sites::links) return {0.0, stretch.site + 1.0, 0.0};
    const auto& link = chain.links[index(stretch.site)];
    return {0.0, 0.5 * (link.between[0] + link.between[1]), 0.0};
  }
  const auto* members = std::get_if<fem::Structure>(&structure);
  if (members == nullptr) return nullptr;
  fem::Vector3 at = {};
  if (kind.line.is_beam()) {
    at[0] = 0.5 * (place.start + place.end);
  } else if (kind.type->sites == DefectType::Sites::nodes) {
    at = members->nodes[index(stretch.site)].at;
  } else {
    const fem::MemberFrame frame = fem::member_frame(*members, stretch.site);
    const fem::Vector3& from =
        members->nodes[index(members->members[index(stretch.site)].nodes[0])].at;
    for (std::size_t d = 0; d < 3; ++d)
      at[d] = from[d] + 0.5 * (place.start + place.end) * frame.axes[0][d];
  }
  return {compact(at[0]), compact(at[1]), compact(at[2])};
}

Report drawing_report(const AnyStructure& structure) {
  if (std::holds_alternative<fem::MatrixStructure>(structure)) return nullptr;
  const fem::StructureDrawing drawing = identification::drawn(structure).drawing;
  Report points = Report::array(), lines = Report::array();
  for (const auto& p : drawing.points)
    points.push_back({compact(p.at[0]), compact(p.at[1]), compact(p.at[2])});
  for (const auto& line : drawing.lines) lines.push_back(line);
  return {{"dimension", drawing.dimension}, {"points", points}, {"lines", lines}};
}

void add_places(const PlanCaseFile& parsed, const PlannedStructure& structure,
                const PlanFindings& findings, Report& plan) {
  const AnyStructure solved = parsed.plan.damage_case.solved_structure();
  Report map = Report::array(), smallest = Report::array();
  for (const PlaceDetection& found : findings.places) {
    const TestPlace& place = structure.places()[index(found.place)];
    const DefectKind& kind = structure.kinds()[index(place.kind)];
    Report row = place_report(structure, place), least = row;
    least[kind.severity_name()] = optional_number(found.smallest);
    least["low"] = optional_number(found.smallest_low);
    least["high"] = optional_number(found.smallest_high);
    smallest.push_back(std::move(least));
    row["severity"] = kind.severity_name();
    row["at"] = drawn_place(solved, kind, place);
    Report severities = Report::array(), detection = Report::array(), right = Report::array(),
           mcse = Report::array();
    for (std::size_t i = 0; i < found.severities.size(); ++i) {
      severities.push_back(finite(found.severities[i]));
      detection.push_back(compact(found.detection[i].value));
      mcse.push_back(compact(found.detection[i].mcse));
      right.push_back(finite(found.right[i].value));
    }
    row["severities"] = severities;
    row["detection"] = detection;
    row["mcse"] = mcse;
    row["right_place"] = right;
    map.push_back(std::move(row));
  }
  plan["smallest_detectable"] = smallest;
  plan["detection_map"] = map;
  plan["drawing"] = drawing_report(solved);
  Report places = Report::array();
  for (const auto& d : parsed.drawn)
    places.push_back(d ? Report{{"at", {compact(d->at[0]), compact(d->at[1]), compact(d->at[2])}},
                                {"direction", {d->direction[0], d->direction[1], d->direction[2]}}}
                       : Report(nullptr));
  plan["candidate_places"] = places;
}

Report value_report(const PlanFindings& findings) {
  const ValueFindings& value = *findings.value;
  Report options = Report::array(), sensitivity = Report::array();
  for (std::size_t i = 0; i < findings.options.size(); ++i) {
    const TestValue& v = value.values[i];
    options.push_back({{"name", findings.options[i].name},
                       {"sensors", findings.options[i].sensors},
                       {"seconds", findings.options[i].seconds},
                       {"test_cost", v.test_cost},
                       {"saving", finite(v.saving)},
                       {"mcse", finite(v.mcse)},
                       {"false_alarm", compact(v.false_alarm)},
                       {"detection", compact(v.detection)}});
  }
  const auto named = [&](int best) {
    return best < 0 ? Report(nullptr) : Report(findings.options[index(best)].name);
  };
  for (const CostSensitivity& s : value.sensitivity)
    sensitivity.push_back({{"cost", s.cost},
                           {"factor", s.factor},
                           {"best", named(s.best)},
                           {"saving", finite(s.saving)}});
  return {{"without_test", value.without_test},
          {"inspects_without_test", value.inspects_without},
          {"options", options},
          {"best", value.best < 0 ? Report(nullptr) : Report(value.best)},
          {"best_name", named(value.best)},
          {"sensitivity", sensitivity}};
}

/// Differences between engine and approximation, and corrected estimates of the best design.
Report check_report(const ScoredDesign& best, const EngineCheck& check) {
  const auto corrected = [](const TestEstimate& by_plan, const TestEstimate& difference) {
    return Report{{"difference", finite(difference.value)},
                  {"difference_se", finite(difference.mcse)},
                  {"corrected", finite(std::clamp(by_plan.value + difference.value, 0.0, 1.0))},
                  {"se", finite(std::hypot(by_plan.mcse, difference.mcse))}};
  };
  Report tests = Report::array();
  for (const CheckedTest& t : check.tests)
    tests.push_back(
        {{"model", t.approximate.model},
         {"probability_damaged", compact(1.0 / (1.0 + std::exp(-t.approximate.log_odds)))},
         {"engine_probability_damaged", compact(t.engine.probability_damaged)},
         {"right", t.approximate.right},
         {"engine_right", t.engine.right},
         {"truth_gain", compact(t.engine.truth_gain)}});
  return {{"tests", check.tests.size()},
          {"damaged", check.damaged},
          {"missed", check.missed},
          {"detection", corrected(best.scores.detection, check.detection)},
          {"right_place", corrected(best.scores.right_place, check.right_place)},
          {"rms_probability_damaged", finite(check.rms_probability)},
          {"each", tests}};
}

std::vector<std::string> cautions(const PlanFindings& f) {
  std::vector<std::string> out;
  constexpr double kLargeInteraction = 0.5;
  if (f.interaction_high > kLargeInteraction)
    out.push_back(
        "For 10 % of the pairs of damages, the error of their approximate joint effect is more "
        "than " +
        significant(f.interaction_high, 2) +
        " standard errors per measured value. Probabilities for two damages may be too low.");
  if (f.unknown_high > kLargeInteraction)
    out.push_back(
        "The effect of the unknown coefficients on the data is not linear: for 10 % of the values "
        "drawn from their priors, the error of the linear approximation is more than " +
        significant(f.unknown_high, 2) +
        " standard errors per measured value. Use narrower priors, or check with --check 100.");
  if (!f.without_shapes.empty()) {
    std::vector<int> modes;
    for (const int i : f.without_shapes) modes.push_back(i + 1);
    out.push_back("The shapes of " + name_modes(modes) +
                  " are not used: these modes are so close that a small model error mixes them.");
  }
  return out;
}

}  // namespace

Report plan_summary(const PlanCaseFile& parsed, const PlanFindings& findings,
                    const EngineCheck& check, const RunInfo& info) {
  const PlanCase& plan = parsed.plan;
  const PlannedStructure structure(plan.damage_case, plan.structure);
  Report names = Report::array();
  for (const Sensor& s : plan.structure.candidates) names.push_back(s.name);
  Report out = {{"wheeltap", about("plan", info, parsed.parsed.file)},
                {"title", parsed.parsed.damage.title}};
  Report p = {
      {"candidates", names},
      {"choose", plan.choose},
      {"seconds", parsed.parsed.file.json.at("plan").contains("seconds")
                      ? Report(plan.noise.seconds)
                      : Report()},
      {"false_alarm", plan.false_alarm},
      {"tolerance", plan.tolerance},
      {"frequencies_hz", findings.frequencies_hz},
      {"frequency_cov", findings.frequency_cov},
      {"shape_sd", plan.choose >= 2 ? Report(findings.shape_sd) : Report(nullptr)},
      {"probability_damaged", findings.probability_damaged},
      {"scenarios", findings.scenarios},
      {"variation_scenarios", findings.variation_scenarios},
      {"search",
       {{"exhaustive", findings.search.exhaustive},
        {"compared", findings.search.compared},
        {"scenarios", findings.search.scenarios},
        {"layouts", layout_count(static_cast<int>(names.size()), plan.choose)}}},
      {"designs", designs_report(parsed, findings.designs)},
      {"others", designs_report(parsed, findings.others)},
      {"frequencies_alone", design_report(parsed, findings.frequencies_alone)},
      {"by_sensors", designs_report(parsed, findings.by_sensors)},
      {"by_length", designs_report(parsed, findings.by_length)},
      {"by_modes", designs_report(parsed, findings.by_modes)},
      {"by_mass", designs_report(parsed, findings.by_mass)},
      {"indistinguishable", confusion_report(findings.confusion)},
      {"resolution", resolution_report(findings.confusion)},
      {"separation",
       {{"sensors", separation_report(parsed, findings.separations.by_sensors)},
        {"mass", separation_report(parsed, findings.separations.by_mass)}}},
      {"alone",
       {{"indistinguishable", confusion_report(findings.confusion_alone)},
        {"separation",
         {{"sensors", separation_report(parsed, findings.separations_alone.by_sensors)},
          {"mass", separation_report(parsed, findings.separations_alone.by_mass)}}}}},
      {"undetectable_places", findings.confusion.undetectable.size()},
      {"interaction",
       {{"median", compact(findings.interaction_median)},
        {"q90", compact(findings.interaction_high)}}},
      {"unknown_coefficients",
       {{"median", compact(findings.unknown_median)}, {"q90", compact(findings.unknown_high)}}}};
  add_places(parsed, structure, findings, p);
  if (findings.value) p["value"] = value_report(findings);
  if (!check.tests.empty()) p["check"] = check_report(findings.designs.front(), check);
  out["plan"] = std::move(p);
  Report warnings = Report::array();
  for (const std::string& text : cautions(findings)) warnings.push_back(text);
  out["diagnostics"] = {{"warnings", warnings}};
  return out;
}

Report recommended_case(const PlanCaseFile& parsed, const PlanFindings& findings) {
  const PlanCase& plan = parsed.plan;
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const ScoredDesign& best = findings.designs.front();
  // The location whose smallest detectable damage is largest; if no damage is detectable, the
  // location with the most detections.
  const PlaceDetection* chosen = nullptr;
  for (const PlaceDetection& p : findings.places) {
    const auto rank = [](const PlaceDetection& x) {
      // Relative to the largest severity, because kinds of defect have different units.
      return x.smallest ? std::pair{1, *x.smallest / x.severities.back()}
                        : std::pair{0, x.detection.back().value};
    };
    if (chosen == nullptr || rank(p) > rank(*chosen)) chosen = &p;
  }
  const TestPlace& place = structure.places()[index(chosen->place)];
  const DefectKind& kind = structure.kinds()[index(place.kind)];
  Report defect = Report::object();
  const SiteLine::Stretch& stretch = kind.line.stretches()[index(place.stretch)];
  if (!kind.line.is_beam()) defect[kind.site_name()] = stretch.name;
  if (stretch.size > 0.0) defect["location"] = compact(0.5 * (place.start + place.end));
  const double severity = chosen->smallest.value_or(chosen->severities.back());
  if (std::isfinite(severity)) defect[kind.severity_name()] = compact(severity);
  const int modes = structure.chosen().back() + 1;
  double cov = 0.0;
  for (const double c : findings.frequency_cov) cov = std::max(cov, c);
  Report out = Report::object();
  for (const auto& [key, value] : parsed.parsed.file.json.items())
    if (key != "plan" && key != "damage" && key != "notes") out[key] = value;
  out["title"] = parsed.parsed.damage.title + ": the planned test";
  out["notes"] = {
      "wheeltap plan wrote this case with the recommended sensors and the uncertainty of the data.",
      "Wheeltap simulates a test from \"truth\". After the real test, delete \"truth\". In "
      "\"data\", keep only \"sensors\", and add \"from\": \"modes.json\"."};
  if (modes > structure.modes())
    out["notes"].push_back("The planned test measures " + std::to_string(structure.modes()) +
                           " of the lowest " + std::to_string(modes) + " modes, from number " +
                           std::to_string(structure.chosen().front() + 1) +
                           " on. The simulated test has all of them: in its data, replace the "
                           "frequencies and shapes of the other modes by null.");
  // A case with unknown coefficients needs measured modes: Wheeltap does not simulate its data.
  const bool known = structure.unknowns() == 0;
  if (!known)
    out["notes"] = {
        "wheeltap plan wrote this case with the recommended sensors. Put the modes.json of the "
        "test in the folder of this case."};
  Report data = {{"cov", compact(cov)}};
  Report truth = {{"defects", Report::array({defect})}, {"cov", compact(cov)}, {"modes", modes}};
  if (best.design.sensors.size() >= 2) {
    Report sensors = Report::array();
    for (const int s : best.design.sensors) sensors.push_back(Report(parsed.sensors[index(s)]));
    data["sensors"] = sensors;
    data["shape_sd"] = compact(findings.measured_shape_sd);
    truth["shape_sd"] = compact(findings.measured_shape_sd);
  }
  if (!known) {
    Report measured = {{"from", "modes.json"}};
    if (data.contains("sensors")) measured["sensors"] = data["sensors"];
    data = measured;
  }
  out["data"] = data;
  Report damage = Report(parsed.parsed.file.json.at("damage"));
  auto& blocks = damage.is_array() ? damage[index(place.kind)] : damage;
  if (damage.is_array())
    for (auto& block : damage) block.erase("truth");
  if (known) blocks["truth"] = truth;
  out["damage"] = damage;
  return out;
}

}  // namespace wheeltap::apps
