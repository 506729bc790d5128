#include "apps/results/update_summary.hpp"

#include <cmath>

#include "apps/draw_columns.hpp"
#include "apps/results/measured/repeats_summary.hpp"
#include "apps/text/answer.hpp"
#include "apps/text/update_words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

Report contractions_of(const UpdateFindings& findings) {
  Report out = Report::object();
  for (const Contraction& c : findings.contractions) {
    using Bound = Contraction::Bound;
    out[c.name] = {{"contraction", c.contraction},
                   {"shift", c.shift},
                   {"at_prior", c.at_prior()},
                   {"bound", c.bound == Bound::none    ? Report()
                             : c.bound == Bound::upper ? Report("upper")
                                                       : Report("lower")}};
  }
  return out;
}

Report untold_of(const UpdateFindings& findings) {
  Report pairs = Report::array(), directions = Report::array();
  for (const Entangled& e : findings.entangled)
    pairs.push_back({{"parameters", {e.a, e.b}}, {"correlation", e.correlation}});
  for (const UntouchedDirection& d : findings.untouched) {
    Report weights = Report::object();
    for (const auto& [name, weight] : d.weights) weights[name] = weight;
    directions.push_back({{"contraction", d.contraction}, {"weights", weights}});
  }
  return {{"sentences", cannot_tell(findings)}, {"entangled", pairs}, {"untouched", directions}};
}

Report solutions_of(const UpdateFindings& findings) {
  Report rows = Report::array();
  const auto& parameters = findings.models[0].parameters;
  for (const Solution& s : findings.solutions) {
    Report values = Report::object(), best = Report::object();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const Marginal& e = s.parameters[p];
      values[parameters[p].unknown.label] = {
          {"mean", e.mean}, {"sd", e.sd}, {"q2.5", e.q2_5}, {"q50", e.q50}, {"q97.5", e.q97_5}};
      best[parameters[p].unknown.label] = s.best[p];
    }
    rows.push_back({{"probability", s.probability},
                    {"mcse", finite(s.mcse)},
                    {"parameters", values},
                    {"best_draw", best},
                    {"chi_square", finite(s.chi_square)}});
  }
  return rows;
}

Report modes_of(const UpdateFindings& findings) {
  Report rows = Report::array();
  for (const ModeFinding& m : findings.modes) {
    Report row = {{"mode", m.mode},
                  {"observed", finite(m.measured_hz)},
                  {"sd", finite(m.sd_hz)},
                  {"mean", m.frequency_hz.mean},
                  {"q2.5", m.frequency_hz.q2_5},
                  {"q97.5", m.frequency_hz.q97_5},
                  {"standardised_residual", finite(m.residual)},
                  {"computed_mode", m.computed},
                  {"matched", m.matched},
                  {"off", m.is_off()},
                  {"without_it",
                   {{"information_nats", finite(m.information)},
                    {"moves", m.moves},
                    {"by_sd", m.moved},
                    {"reliable", m.reliable}}}};
    if (m.spurious > 0.0) row["spurious"] = m.spurious;
    if (!m.state.empty()) row.update({{"state", m.state}, {"mode_of_state", m.mode_of_state}});
    if (m.has_shape)
      row["shape"] = {{"mac", {{"q2.5", m.mac.q2_5}, {"q50", m.mac.q50}, {"q97.5", m.mac.q97_5}}},
                      {"chi_square", m.shape_chi_square},
                      {"freedoms", m.shape_freedoms},
                      {"p", m.shape_p}};
    rows.push_back(std::move(row));
  }
  return rows;
}

Report update_data_of(const UpdateCaseFile& parsed, const UpdateFindings& findings) {
  const ModalData& data = parsed.update.data;
  Report sensors = Report::array();
  for (const Sensor& sensor : data.sensors) sensors.push_back(sensor.name);
  Report out = {{"origin", data.origin},
                {"simulated", data.simulated},
                {"numbers", findings.numbers},
                {"modes", modes_of(findings)},
                {"posterior_predictive_p", findings.fit.p},
                {"sensors", sensors}};
  if (const auto& n = findings.numbering)
    out["numbering"] = {
        {"modes", n->measured},
        {"probability", n->probability},
        {"likeliest_other",
         n->likeliest.modes.empty()
             ? Report()
             : Report({{"modes", n->likeliest.modes}, {"probability", n->likeliest.probability}})},
        {"draws", n->draws}};
  if (data.has_shapes()) {
    out["shapes"] = rows_of(data.shapes);
    out["computed_shapes"] = rows_of(findings.best_shapes);
    out["mac"] = rows_of(findings.mac);
  }
  if (parsed.update.simulation && data.simulated)
    out["truth"] = Report::parse(parsed.file.json["truth"].dump());
  return out;
}

Report predictions_of(const UpdateFindings& findings) {
  Report rows = Report::array();
  for (const PredictedMode& p : findings.predictions) {
    const Marginal& f = p.frequency_hz;
    rows.push_back(
        {{"mode", p.mode},
         {"frequency_hz",
          {{"mean", f.mean}, {"sd", f.sd}, {"q2.5", f.q2_5}, {"q50", f.q50}, {"q97.5", f.q97_5}}},
         {"measurement_hz", {{"q2.5", p.low_hz}, {"q97.5", p.high_hz}}},
         {"held_out_hz", p.measured_hz ? Report(*p.measured_hz) : Report()},
         {"inside", p.measured_hz ? Report(!p.misses()) : Report()},
         {"useful", !p.useless()}});
    if (!p.state.empty()) rows.back()["state"] = p.state;
  }
  return rows;
}

Report reduced_basis_of(const UpdateProblem& problem, const UpdateFindings& findings) {
  if (problem.basis() == nullptr) return {};
  const auto& training = problem.basis()->training();
  return {{"columns", training.basis},
          {"degrees_of_freedom", problem.basis()->structure().nominal().size()},
          {"complete", training.complete},
          {"solved_for_it", training.solved},
          {"tried_at", training.points},
          {"largest_bound", training.largest_bound},
          {"beyond_tolerance", training.beyond},
          {"miscounted", training.miscounted},
          {"in_full", {{"draws", findings.in_full}, {"of", findings.examined}}}};
}

Report update_unknowns_of(const UpdateCaseFile& parsed, const UpdateFindings& findings) {
  Report list = Report::array();
  for (const ParameterFinding& p : findings.models[0].parameters)
    list.push_back({{"label", p.unknown.label},
                    {"variable", variable_of(p.unknown.name)},
                    {"prior", prior_place(parsed.update, p.unknown.name).to_string()},
                    {"unit", p.unknown.unit}});
  return {{findings.models[0].name, list}};
}

}  // namespace

Report update_summary(const UpdateCaseFile& parsed, const UpdateProblem& problem,
                      const UpdateFindings& findings, const RunInfo& info) {
  Report best = Report::object();
  const auto& parameters = findings.models[0].parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p)
    best[parameters[p].unknown.label] = findings.best_draw[p];
  Report summary = {{"wheeltap", about("update", info, parsed.file)},
                    {"title", parsed.update.title},
                    {"notes", parsed.notes},
                    {"answer", json(answer(findings))},
                    {"models", model_table(findings)},
                    {"parameters", parameter_tables(findings)},
                    {"solutions", solutions_of(findings)},
                    {"contraction", contractions_of(findings)},
                    {"cannot_tell", untold_of(findings)},
                    {"unknowns", update_unknowns_of(parsed, findings)},
                    {"fit",
                     {{"ok", findings.fit.ok()},
                      {"r2", finite(findings.fit.r2)},
                      {"p", findings.fit.p},
                      {"best_p", findings.fit.best_p},
                      {"why", misfit_sentences(findings)}}},
                    {"data", update_data_of(parsed, findings)},
                    {"predictions", predictions_of(findings)},
                    {"best_draw", best},
                    {"reduced_basis", reduced_basis_of(problem, findings)},
                    {"diagnostics", diagnostics(findings, update_warnings(findings))},
                    {"cost", cost(findings.sampling)}};
  if (Report repeats = repeats_report(&parsed.update.data, parsed.update.states.get());
      !repeats.is_null())
    summary["repeats"] = std::move(repeats);
  summary["cost"]["seconds_a_likelihood"] = problem.seconds_a_likelihood;
  if (!findings.evidence.empty()) summary["evidence"] = evidence_report(findings);
  return summary;
}

}  // namespace wheeltap::apps
