#include "apps/results/damage_summary.hpp"

#include <algorithm>
#include <cmath>

#include "apps/results/baseline_words.hpp"
#include "apps/results/measured/repeats_summary.hpp"
#include "apps/results/posterior_file.hpp"
#include "apps/text/answer.hpp"
#include "apps/text/damage_words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

// Expected number of defects on each member (node, link), {"left post": 0.9}, for each kind.
Report by_member(const DamageCase& damage_case, const DamageFindings& findings) {
  Report out = Report::object();
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    Report one = Report::object();
    for (const SiteLine::Stretch& s : kind.line.stretches()) one[s.name] = 0.0;
    for (std::size_t c = 0; c < findings.kinds[k].expected.size(); ++c) {
      const int stretch = kind.line.stretch_of_cell(static_cast<int>(c));
      Report& sum = one[kind.line.stretches()[static_cast<std::size_t>(stretch)].name];
      sum = sum.get<double>() + findings.kinds[k].expected[c];
    }
    (damage_case.kinds.size() > 1 ? out[kind.name] : out) = one;
  }
  return out;
}

// Counts after adjacent damages are merged, and the longer damages that replace them.
Report merged_report(const DefectKind& kind, const DamageFindings& findings,
                     const MergedFinding& merged) {
  Report counts = Report::object(), models = Report::object();
  for (std::size_t n = 0; n < merged.count.size(); ++n) counts[std::to_string(n)] = merged.count[n];
  for (const MergedModel& m : merged.models) {
    const ModelFinding& model = findings.models[static_cast<std::size_t>(m.model)];
    const int damages = model.counts[static_cast<std::size_t>(merged.kind)];
    Report& one = models[model.name] = {{"merged", m.merged},
                                        {"count", m.count},
                                        {"location", json(m.location)},
                                        {"extent", json(m.length)},
                                        {kind.severity_name(), json(m.reduction)},
                                        {"log_likelihood_gain", finite(m.gain)},
                                        {"statement", longer_in_words(kind, damages, m)}};
    if (!kind.line.is_beam())
      one[kind.site_name()] = kind.line.stretches()[static_cast<std::size_t>(m.stretch)].name;
  }
  return {
      {"probability_of_count", counts}, {"probability_merged", merged.merged}, {"models", models}};
}

Report where(const DamageCase& damage_case, const DamageFindings& findings) {
  Report by_element = Report::object(), all_places = Report::object();
  const bool several = damage_case.kinds.size() > 1;
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    const KindFinding& found = findings.kinds[k];
    Report given = Report::object();
    for (const auto& [count, expected] : found.given_count) given[std::to_string(count)] = expected;
    const Report one = {{"overall", found.expected}, {"given_count", given}};
    (several ? by_element[kind.name] : by_element) = one;
    Report places = Report::array();
    for (const Place& p : found.places) {
      Report place = {
          {"from", p.from}, {"to", p.to}, {"expected", p.expected}, {"location", json(p.location)}};
      if (damage_case.structure) {
        const auto& on = kind.line.stretches()[static_cast<std::size_t>(p.stretch)];
        place[kind.site_name()] = on.name;
      }
      if (p.severity) place[kind.severity_name()] = json(*p.severity);
      if (p.extent) place["extent"] = json(*p.extent);
      places.push_back(std::move(place));
    }
    all_places[kind.name] = places;
  }
  Report out = {{"inclusion_by_element", by_element}, {"places", all_places}};
  for (const MergedFinding& merged : findings.merged) {
    const DefectKind& kind = damage_case.kinds[static_cast<std::size_t>(merged.kind)];
    (several ? out["merged"][kind.name] : out["merged"]) = merged_report(kind, findings, merged);
  }
  if (damage_case.structure) out["inclusion_by_member"] = by_member(damage_case, findings);
  if (!findings.folded.empty()) {
    Report folded = Report::object();
    for (std::size_t m = 0; m < findings.folded.size(); ++m) {
      if (!findings.folded[m].empty()) folded[findings.models[m].name] = json(findings.folded[m]);
    }
    out["folded"] = folded;
  }
  return out;
}

Report json(const SymmetryFinding& symmetry) {
  Report chains = Report::array();
  for (const auto& c : symmetry.chains) {
    chains.push_back(
        {{"left", c.left}, {"right", c.right}, {"mcse_of_difference", c.mcse_of_difference}});
  }
  if (!symmetry.alike.empty() || !symmetry.turned.empty())
    return {{"alike", symmetry.alike},
            {"turned", symmetry.turned},
            {"statement", images_statement(symmetry.alike, symmetry.turned)},
            {"per_chain", chains}};
  return {{"mirror_symmetric", true},
          {"center", symmetry.center},
          {"statement", symmetry_statement(symmetry.emulated)},
          {"per_chain", chains}};
}

Report json(const FitFinding& fit) {
  Report rows = Report::array();
  for (std::size_t mode = 0; mode < fit.modes.size(); ++mode) {
    const FitFinding::Mode& m = fit.modes[mode];
    rows.push_back({{"mode", mode + 1},
                    {"observed", finite(m.observed)},
                    {"sd", finite(m.sd)},
                    {"mean", m.mean},
                    {"q2.5", m.q2_5},
                    {"q97.5", m.q97_5},
                    {"standardised_residual", finite(m.standardised_residual)}});
    Report& row = rows.back();
    if (!m.state.empty()) row.update({{"state", m.state}, {"mode_of_state", m.mode}});
    if (m.mac)
      row["shape"] = {
          {"mac", {{"q2.5", m.mac->q2_5}, {"q50", m.mac->q50}, {"q97.5", m.mac->q97_5}}}};
    if (!std::isnan(m.information))
      row["without_it"] = {{"information_nats", finite(m.information)},
                           {"probability", m.probability_without},
                           {"reliable", m.reliable}};
  }
  return {{"modes", rows}, {"posterior_predictive_p", fit.posterior_predictive_p}};
}

// Measured and computed shapes, as a list of states.
Report shapes_of(const DamageCase& damage_case, const FitFinding& fit) {
  Report out = Report::array();
  for (const ShapesBeside& beside : fit.shapes) {
    const ObservedState* state =
        damage_case.states() ? &damage_case.states()->list[static_cast<std::size_t>(beside.state)]
                             : nullptr;
    const ModalData& data = state != nullptr ? state->data : *damage_case.modal();
    Report sensors = Report::array();
    for (const Sensor& sensor : data.sensors) sensors.push_back(sensor.name);
    out.push_back({{"state", state != nullptr ? Report(state->name) : Report()},
                   {"sensors", sensors},
                   {"shapes", rows_of(data.shapes)},
                   {"computed_shapes", rows_of(beside.computed)},
                   {"mac", rows_of(beside.mac)}});
  }
  return out;
}

Report json(const EmulatorCheck& check, const std::vector<ModelFinding>& of) {
  const auto shift = [](const Shift& s) -> Report {
    return {{"emulator", s.emulator}, {"fe", s.fe}, {"standard_error", s.standard_error}};
  };
  Report models = Report::array(), parameters = Report::object(), by_mode = Report::array();
  for (std::size_t m = 0; m < check.models.size(); ++m) {
    Report row = {{"name", of[m].name}};
    row.update(shift(check.models[m].probability));
    models.push_back(row);
    if (!check.models[m].compared) continue;
    Report& table = parameters[of[m].name] = Report::object();
    for (std::size_t p = 0; p < check.models[m].means.size(); ++p) {
      table[of[m].parameters[p].unknown.label] = shift(check.models[m].means[p]);
    }
  }
  for (std::size_t mode = 0; mode < check.error_to_noise.size(); ++mode) {
    by_mode.push_back({{"mode", mode + 1},
                       {"rms", check.error_to_noise[mode].rms},
                       {"largest", check.error_to_noise[mode].largest}});
  }
  return {{"draws", check.draws},
          {"mean_log_weight", check.mean_log_weight},
          {"sd_log_weight", check.sd_log_weight},
          {"effective_share", check.effective_share},
          {"pareto_shape", finite(check.pareto_shape)},
          {"conclusive", check.conclusive},
          {"moved", check.answer_moved()},
          {"models", models},
          {"parameters", parameters},
          {"error_to_noise", by_mode},
          {"worst_mode", check.worst_mode}};
}

bool is_of_structure(const ObservedStates& states, const std::string& name) {
  const auto parameters = states.parameters();
  return std::ranges::find(parameters, name, &inference::Parameter::name) != parameters.end();
}

// Name, variable in posterior.nc and location of the prior in the case, for each unknown.
Report unknowns_of(const DamageCaseFile& file, const DamageFindings& findings) {
  Report out = Report::object();
  for (const ModelFinding& model : findings.models) {
    Report list = Report::array();
    for (const ParameterFinding& p : model.parameters) {
      const Unknown& u = p.unknown;
      const auto kind = static_cast<std::size_t>(u.kind);
      const bool own = file.damage.states() && is_of_structure(*file.damage.states(), u.name);
      const Pointer prior = u.kind >= 0                     ? file.kinds[kind] / u.name
                            : own && u.name == kPerKelvin   ? Pointer("/temperature") / u.name
                            : own                           ? Pointer("/parameters") / u.name
                            : u.name == "discrepancy"       ? Pointer("/data/discrepancy/cov")
                            : u.name == "shape_discrepancy" ? Pointer("/data/discrepancy/shape")
                            : u.name == "mixing"            ? Pointer("/data/discrepancy/mixing")
                            : u.name == "stiffness_discrepancy"
                                ? Pointer("/data/discrepancy/stiffness")
                                : Pointer("/data") / u.name;
      Report one = {{"label", u.label},
                    {"variable", damage_variable(file.damage, u)},
                    {"prior", prior.to_string()}};
      if (u.kind >= 0) {
        one["slot"] = u.component + 1;
        // Components are sorted by their first parameter.
        if (u.parameter == 0) one["ordered_among"] = model.counts[kind];
      }
      list.push_back(std::move(one));
    }
    if (!list.empty()) out[model.name] = std::move(list);
  }
  return out;
}

// Length of one defect: "element", metres, or null if the length is inferred or does not exist.
Report extent_of(const DefectKind& kind) {
  if (kind.extent) return *kind.extent;
  return has_fixed_extent(kind) ? Report("element") : Report();
}

Report kinds_of(const DamageCase& damage_case) {
  Report kinds = Report::array();
  for (const DefectKind& kind : damage_case.kinds) {
    Report truth = Report::array();
    for (const auto& t : kind.truth) {
      Report one = {
          {"location", t.location},
          {kind.severity_name(), std::isfinite(t.severity) ? Report(t.severity) : Report("rigid")}};
      if (kind.extent_prior) one["extent"] = t.extent;
      if (!kind.line.is_beam()) {
        const SiteLine::Spot spot = kind.line.spot(t.location);
        one[kind.site_name()] = kind.line.stretches()[static_cast<std::size_t>(spot.stretch)].name;
        one["location"] = spot.s;
      }
      truth.push_back(std::move(one));
    }
    kinds.push_back({{"name", kind.name},
                     {"plural", kind.plural},
                     {"severity", kind.severity_prior() ? Report(kind.severity_name()) : Report()},
                     {"unit", kind.severity_unit()},
                     {"share", kind.type->percent},
                     {"extent", extent_of(kind)},
                     {"truth", truth}});
  }
  return kinds;
}

Report supports_of(const fem::Beam& beam) {
  Report list = Report::array();
  for (const fem::Support& s : beam.supports) {
    list.push_back({{"at", s.at},
                    {"deflection", s.deflection},
                    {"rotation", s.rotation},
                    {"stiffness", s.stiffness ? Report(*s.stiffness) : Report("rigid")}});
  }
  return list;
}

Report beam_of(const fem::Beam& beam) {
  return {{"length", beam.length},
          {"elements", beam.elements},
          {"supports", supports_of(beam)},
          {"shear_coefficient", beam.section.shear_coefficient}};
}

// Points, lines, and their motion in the modes of the intact structure, for an animation.
Report drawing_of(const DrawnModes& drawn) {
  const auto rounded = [](const fem::Vector3& v) {
    Report row = Report::array();
    for (const double x : v) row.push_back(std::round(1e4 * x) / 1e4);
    return row;
  };
  Report points = Report::array(), modes = Report::array();
  for (const auto& point : drawn.drawing.points) points.push_back(point.at);
  for (std::size_t j = 0; j < drawn.motions.size(); ++j) {
    Report motions = Report::array();
    for (const fem::Vector3& v : drawn.motions[j]) motions.push_back(rounded(v));
    modes.push_back({{"frequency_hz", drawn.frequencies_hz[j]}, {"motions", motions}});
  }
  return {{"points", points}, {"lines", drawn.drawing.lines}, {"modes", modes}};
}

// Nodes, members, supported nodes, and the cells of each kind.
Report structure_of(const DamageCase& damage_case, const std::optional<DrawnModes>& drawn) {
  Report out = Report::object();
  if (const auto* s = std::get_if<fem::Structure>(&damage_case.structure->nominal)) {
    out["dimension"] = s->dimension;
    Report nodes = Report::array(), members = Report::array(), supports = Report::array();
    for (const fem::Node& node : s->nodes) nodes.push_back({{"name", node.name}, {"at", node.at}});
    for (const fem::Member& m : s->members)
      members.push_back({{"name", m.name}, {"nodes", m.nodes}, {"elements", m.elements}});
    for (const fem::NodeSupport& support : s->supports)
      supports.push_back({{"node", support.node}, {"fix", support.fix}});
    out.update({{"nodes", nodes}, {"members", members}, {"supports", supports}});
  } else if (const auto* chain = std::get_if<fem::LumpedChain>(&damage_case.structure->nominal)) {
    Report links = Report::array();
    for (const fem::LumpedChain::Link& link : chain->links)
      links.push_back({{"name", link.name}, {"between", link.between}});
    out.update({{"masses", chain->masses}, {"links", links}});
  } else if (const auto* matrices =
                 std::get_if<fem::MatrixStructure>(&damage_case.structure->nominal)) {
    Report names = Report::array();
    for (const auto& part : matrices->parts) names.push_back(part.name);
    out.update({{"degrees_of_freedom", matrices->mass.rows()}, {"substructures", names}});
  }
  Report lines = Report::object();
  for (const DefectKind& kind : damage_case.kinds) {
    Report stretches = Report::array();
    for (const SiteLine::Stretch& s : kind.line.stretches())
      stretches.push_back({{"site", s.site}, {"name", s.name}, {"first_cell", s.first_cell}});
    for (Report& s : stretches)
      if (!kind.groups.empty()) s["members"] = kind.groups[s["site"].get<std::size_t>()];
    lines[kind.name] = {{"of", kind.site_name()}, {"stretches", stretches}};
  }
  out["lines"] = lines;
  if (drawn) out["drawing"] = drawing_of(*drawn);
  return out;
}

}  // namespace

Report emulator_report(const EmulatorFinding& emulator) {
  Report counts = Report::object();
  for (std::size_t c = 0; c < emulator.counts.size(); ++c) {
    const EmulatorFinding::Count& count = emulator.counts[c];
    Report rows = Report::array();
    for (std::size_t mode = 0; mode < count.modes.size(); ++mode) {
      const EmulatorFinding::Mode& m = count.modes[mode];
      Report row = {{"mode", mode + 1},
                    {"rmse", m.rmse},
                    {"max_error", m.max_error},
                    {"q2", finite(m.q2)},
                    {"relative_rmse", m.relative_rmse},
                    {"noise", finite(m.noise)}};
      if (m.leave_one_out) row["leave_one_out"] = *m.leave_one_out;
      if (m.standardised) {
        row["standardised"] = {{"mean", m.standardised->mean},
                               {"rms", finite(m.standardised->rms)},
                               {"beyond_two", m.standardised->beyond_two}};
      }
      rows.push_back(std::move(row));
    }
    const int damages = static_cast<int>(c) + 1;
    const std::string warning = emulator_warning(damages, count.blind);
    Report& entry = counts[std::to_string(damages)] = {
        {"kind", count.kind},
        {"runs", count.runs},
        {"modes", rows},
        {"warning", warning.empty() ? Report() : Report(warning)}};
    if (count.worst_mode > 0) {
      entry["worst"] = {{"mode", count.worst_mode},
                        {"rmse_to_noise", count.rmse_to_noise},
                        {"largest_to_noise", count.largest_to_noise}};
    }
  }
  return {{"counts", counts}};
}

Context damage_context(const DamageCaseFile& damage_case, const DamageFindings& findings) {
  Context context{.damage_case = &damage_case.damage, .damage = &findings};
  for (const Pointer& where : damage_case.kinds) {
    std::string key = where.to_string().substr(1);
    std::ranges::replace(key, '/', '.');
    context.kinds.push_back(std::move(key));
  }
  return context;
}

std::vector<std::string> damage_warnings(const DamageCaseFile& file,
                                         const DamageFindings& findings) {
  std::vector<std::string> out = warnings(findings, damage_context(file, findings));
  for (std::string& one : baseline_sentences(findings)) out.push_back(std::move(one));
  return out;
}

Report damage_summary(const DamageCaseFile& file, const DamageFindings& findings,
                      const RunInfo& info) {
  const DamageCase& damage_case = file.damage;
  Report diagnosed = diagnostics(findings, damage_warnings(file, findings));
  if (findings.symmetry) diagnosed["symmetry"] = json(*findings.symmetry);
  Report summary = {
      {"wheeltap", about("damage", info, file.file)},
      {"title", damage_case.title},
      {"notes", file.notes},
      {"answer", json(answer(damage_case, findings))},
      {"models", model_table(findings)},
      {"parameters", parameter_tables(findings)},
      {"damage", where(damage_case, findings)},
      {"data", {{"origin", damage_case.data.origin}, {"simulated", damage_case.data.simulated}}},
      {damage_case.structure ? "structure" : "beam",
       damage_case.structure ? structure_of(damage_case, findings.drawn_modes)
                             : beam_of(damage_case.beam)},
      {"kinds", kinds_of(damage_case)},
      {"unknowns", unknowns_of(file, findings)},
      {"fit", fit_report(findings.fit_verdict)},
      {"diagnostics", diagnosed},
      {"cost", cost(findings.sampling)}};
  if (damage_case.baseline) {
    Report factors = Report::array(), measured = Report::array();
    for (std::size_t i = 0; i < damage_case.baseline->model_hz.size(); ++i) {
      const double f = damage_case.baseline->measured_hz[i];
      measured.push_back(finite(f));
      factors.push_back(finite(f / damage_case.baseline->model_hz[i]));
    }
    summary["baseline"] = {{"measured_hz", measured},
                           {"model_hz", damage_case.baseline->model_hz},
                           {"factors", factors},
                           {"statement", baseline_statement(*damage_case.baseline)}};
  }
  if (findings.baseline) summary["baseline"] = baseline_report(damage_case, findings);
  if (Report repeats = repeats_report(damage_case.modal(), damage_case.states().get());
      !repeats.is_null())
    summary["repeats"] = std::move(repeats);
  if (damage_case.data.discrepancy_cv > 0.0) {
    summary["data"]["discrepancy_cov"] = damage_case.data.discrepancy_cv;
  }
  if (findings.fit) {
    summary["data"].update(json(*findings.fit));
    if (!findings.fit->shapes.empty())
      summary["data"]["shapes_of"] = shapes_of(file.damage, *findings.fit);
  }
  if (findings.emulator) {
    const EmulatorFinding& e = *findings.emulator;
    Report emulator = emulator_report(e);
    emulator["exact"] = e.exact;
    emulator["error_in_likelihood"] = e.error_in_likelihood;
    emulator["full_model_calls"] = {{"training", e.training_calls},
                                    {"validation", e.validation_calls},
                                    {"likelihood", e.likelihood_calls},
                                    {"check", e.check ? e.check->draws : 0}};
    if (e.check) emulator["check"] = json(*e.check, findings.models);
    summary["emulator"] = emulator;
  }
  if (!findings.evidence.empty()) summary["evidence"] = evidence_report(findings);
  return summary;
}

}  // namespace wheeltap::apps
