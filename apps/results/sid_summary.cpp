#include "apps/results/sid_summary.hpp"

#include <cmath>

#include "apps/cases/records/record_reading.hpp"
#include "apps/results/sid_posterior_file.hpp"
#include "apps/text/answer.hpp"
#include "apps/text/sid_words.hpp"
#include "identification/sid/sid_units.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

Report whiteness_json(const ResidualWhiteness& whiteness) {
  return {{"test", "Ljung-Box"},
          {"of", whiteness.of_innovations ? "innovations" : "residuals"},
          {"lags", whiteness.lags},
          {"statistic", whiteness.test.statistic},
          {"degrees_of_freedom", whiteness.test.degrees_of_freedom},
          {"p_value", whiteness.test.p_value},
          {"lag_1_autocorrelation", whiteness.lag_1},
          {"largest", {{"lag", whiteness.worst_lag}, {"autocorrelation", whiteness.worst}}},
          {"white", whiteness.white()}};
}

Report fits_json(const std::vector<ChannelFit>& fits) {
  Report rows = Report::array();
  for (const ChannelFit& fit : fits) {
    rows.push_back({{"channel", fit.channel},
                    {"mass", fit.mass},
                    {"mse", fit.mse},
                    {"rmse", fit.rmse},
                    {"nrmse", finite(fit.nrmse)},
                    {"r2", finite(fit.r2)},
                    {"noise_sd", fit.noise_sd},
                    {"whiteness", fit.whiteness ? whiteness_json(*fit.whiteness) : Report()}});
  }
  return rows;
}

Report links_json(const std::vector<LinkCurve>& links) {
  Report rows = Report::array();
  for (const LinkCurve& link : links) {
    rows.push_back({{"between", {link.a, link.b}},
                    {"extension", link.extension},
                    {"tension", {{"q2.5", link.q2_5}, {"q50", link.q50}, {"q97.5", link.q97_5}}}});
  }
  return rows;
}

/// Returns {model: value(finding, m), …} for models that have draws and are described in full.
template <class Value>
Report of_drawn(const SidFindings& findings, const Value& value) {
  Report out = Report::object();
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    if (findings.of_models[m] && told_in_full(findings, findings.models[m])) {
      out[findings.models[m].name] = value(*findings.of_models[m], m);
    }
  }
  return out;
}

/// Returns {kind of residual model: {model: value of its residual model, …}, …}.
Report residuals_of(const SidCase& sid_case) {
  Report out = Report::object();
  for (const ResidualKind* kind : residual_kinds()) {
    for (const SidModel& model : sid_case.models) {
      const ResidualModel& own = *model.residuals.model;
      out[std::string(kind->key)][model.name] = own.kind() == kind ? own.value() : 0;
    }
  }
  return out;
}

Report links_report(const SidFindings& findings) {
  Report out = Report::object();
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const auto& found = findings.of_models[m];
    if (found && found->links) out[findings.models[m].name] = links_json(*found->links);
  }
  return out;
}

/// One row per term of a discovery.
Report terms_report(const SidFindings& findings) {
  Report rows = Report::array();
  for (const TermFinding& term : findings.discovery.terms) {
    rows.push_back({{"name", term.name},
                    {"label", term.label},
                    {"link", {term.a, term.b}},
                    {"prior", term.prior},
                    {"inclusion", term.inclusion},
                    {"probability", term.inclusion},
                    {"mcse", finite(term.mcse)},
                    {"parameters", apps::json(term.parameters)}});
  }
  return rows;
}

/// Force laws averaged over all models, and the range of motion of their links.
Report discovery_report(const SidCase& sid_case, const SidFindings& findings) {
  Report laws = Report::array(), motions = Report::array();
  for (const LinkLaw& law : findings.discovery.laws) {
    Report map = Report::array();
    for (const LinkLaw::Point& p : law.map) {
      map.push_back({compact(p.extension), compact(p.rate), compact(p.tension)});
    }
    laws.push_back(
        {{"between", {law.at_rest.a, law.at_rest.b}},
         {"extension", law.at_rest.extension},
         {"tension",
          {{"q2.5", law.at_rest.q2_5}, {"q50", law.at_rest.q50}, {"q97.5", law.at_rest.q97_5}}},
         {"rate", law.rate},
         {"resistance", {{"q2.5", law.q2_5}, {"q50", law.q50}, {"q97.5", law.q97_5}}},
         {"map", map}});
  }
  const auto& links = sid_case.models.front().chain.links;
  for (std::size_t l = 0; l < sid_case.discovery->motions.size(); ++l) {
    const LinkMotion& m = sid_case.discovery->motions[l];
    motions.push_back({{"between", {links[l].a, links[l].b}},
                       {"extension_rms", m.extension},
                       {"rate_rms", m.rate},
                       {"tension_rms", m.tension}});
  }
  return {{"inclusion", sid_case.discovery->inclusion}, {"scales", motions}, {"laws", laws}};
}

Report modes_report(const SidFindings& findings) {
  Report out = Report::object();
  for (std::size_t m = 0; m < findings.models.size(); ++m) {
    const auto& found = findings.of_models[m];
    if (!found || found->modes.empty()) continue;
    Report& rows = out[findings.models[m].name] = Report::array();
    for (const ChainMode& mode : found->modes) {
      rows.push_back({{"frequency_hz", apps::json(mode.frequency_hz)},
                      {"damping_ratio", apps::json(mode.damping_ratio)}});
    }
  }
  return out;
}

Report best_draws(const SidFindings& findings) {
  return of_drawn(findings, [&](const SidModelFinding& found, std::size_t m) {
    Report draw = Report::object();
    const auto& parameters = findings.models[m].parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      draw[parameters[p].unknown.label] = found.best_draw[p];
    }
    return draw;
  });
}

// Variable in posterior.nc and location of the prior in the case, for each unknown.
Report sid_unknowns_of(const SidFindings& findings) {
  return of_drawn(findings, [&](const SidModelFinding&, std::size_t m) {
    Report list = Report::array();
    for (const ParameterFinding& p : findings.models[m].parameters) {
      list.push_back({{"label", p.unknown.label},
                      {"variable", variable_of(p.unknown.name)},
                      {"prior", (Pointer("/parameters") / p.unknown.name).to_string()},
                      {"unit", p.unknown.unit}});
    }
    return list;
  });
}

Report priors_of(const SidCase& sid_case) {
  Report out = Report::object();
  for (const auto& parameter : sid_case.parameters) {
    out[parameter.name] = parameter.prior.describe();
  }
  return out;
}

Report predictive_of(const SidCase& sid_case, const SidFindings& findings) {
  Report rows = Report::array();
  const auto responses = sid_case.responses();
  for (std::size_t c = 0; c < responses.size(); ++c) {
    rows.push_back({{"channel", responses[c]->name()}, {"coverage", findings.coverage[c]}});
  }
  return {{"level", sid_case.band}, {"draws", findings.predictive_draws}, {"channels", rows}};
}

Report data_of(const SidCaseFile& parsed) {
  const SidCase& sid_case = parsed.sid;
  Report responses = Report::array(), window = Report::array(), channels = Report::array();
  for (const SidChannel& channel : sid_case.channels) {
    if (!channel.is_excitation() && channel.role != SidChannel::Role::response) continue;
    Report one = {{"channel", channel.name()}};
    one.update(conversion_json(channel.conversion()));
    channels.push_back(std::move(one));
  }
  for (const SidChannel* channel : sid_case.responses()) {
    responses.push_back(
        {{"channel", channel->name()}, {"mass", channel->mass}, {"unit", channel->used_unit()}});
  }
  for (const SidChannel& channel : sid_case.channels) {
    if (!channel.window) continue;
    window.push_back({{"channel", channel.name()},
                      {"power_ratio", channel.window->power_ratio},
                      {"spectrum_difference_db", channel.window->difference_db},
                      {"scatter_db", channel.window->expected_db}});
  }
  const auto system = unit_system(sid_case);
  Report out = {
      {"origin", sid_case.origin},
      {"simulated", sid_case.simulated},
      {"sample_rate", sid_case.sample_rate_hz},
      {"samples", {sid_case.begin, sid_case.end}},
      {"lead_in", sid_case.lead_in},
      {"responses", responses},
      {"channels", channels},
      {"units", system ? Report({{"force", system->force}, {"length", system->length}}) : Report()},
      {"window_against_record", window}};
  if (!sid_case.simulated) out["sampling"] = sampling_json(sid_case.sampling);
  if (sid_case.layout) out["layout"] = layout_json(*sid_case.layout);
  if (sid_case.truth && sid_case.simulated) {
    out["truth"] = Report::parse(parsed.file.json["truth"].dump());
  }
  return out;
}

/// Origin and fit of each further record.
Report further_of(const SidCase& sid_case, const SidFindings& findings) {
  Report out = Report::array();
  for (std::size_t r = 0; r < sid_case.further.size(); ++r) {
    const SidCase& record = sid_case.further[r];
    out.push_back(
        {{"origin", record.origin},
         {"sample_rate", record.sample_rate_hz},
         {"samples", {record.begin, record.end}},
         {"lead_in", record.lead_in},
         {"fit_at_best_draw", of_drawn(findings, [&](const SidModelFinding& f, std::size_t) {
            return fits_json(f.further[r]);
          })}});
  }
  return out;
}

Report integration_of(const SidProblem& problem, const SidFindings& findings) {
  return {{"upsampled", problem.sid_case.stride},
          {"substeps_at_posterior_mean",
           of_drawn(findings,
                    [](const SidModelFinding& f, std::size_t) { return Report(f.substeps); })},
          {"step_limit", problem.sid_case.integration.step_limit},
          {"error_of_steps", of_drawn(findings,
                                      [](const SidModelFinding& f, std::size_t) {
                                        return f.step_error ? Report(*f.step_error) : Report();
                                      })},
          {"seconds_a_likelihood", problem.seconds_a_likelihood}};
}

}  // namespace

std::string never_visited(const SidFindings& findings, const BayesFactor& factor) {
  const ModelFinding& model = findings.models[static_cast<std::size_t>(factor.model)];
  const ModelFinding& against = findings.models[static_cast<std::size_t>(factor.against)];
  if (model.drawn()) return against.drawn() ? "" : against.name;
  return against.drawn() ? model.name : "both";
}

Report bayes_factors_report(const SidFindings& findings) {
  Report rows = Report::array();
  for (const BayesFactor& factor : findings.bayes_factors) {
    if (!told_in_full(findings, findings.models[static_cast<std::size_t>(factor.model)])) continue;
    const std::string never = never_visited(findings, factor);
    rows.push_back({{"model", findings.models[static_cast<std::size_t>(factor.model)].name},
                    {"against", findings.models[static_cast<std::size_t>(factor.against)].name},
                    {"log_bayes_factor", factor.log ? Report(*factor.log) : Report()},
                    {"mcse", finite(factor.error)},
                    {"basis", factor.basis == inference::Basis::evidence ? "evidence" : "draws"},
                    {"never_visited", never.empty() ? Report() : Report(never)}});
    if (findings.models[static_cast<std::size_t>(factor.model)].standing.passed_over)
      rows.back()["evaluated"] = false;
  }
  return rows;
}

Report fits_report(const SidFindings& findings) {
  return of_drawn(findings,
                  [](const SidModelFinding& f, std::size_t) { return fits_json(f.at_mean); });
}

Report sid_summary(const SidCaseFile& parsed, const SidProblem& problem,
                   const SidFindings& findings, const RunInfo& info) {
  const SidCase& sid_case = problem.sid_case;
  Report diagnosed = diagnostics(findings, warnings(findings, {}));
  if (findings.look) diagnosed["notes"].push_back(in_words(*findings.look));
  for (const SidModel& model : sid_case.models) {
    if (const std::string note = residuals_note(model); !note.empty())
      diagnosed["notes"].push_back(note);
  }
  if (findings.refined) diagnosed["notes"].push_back(repeat_note(*findings.refined));
  Report summary = {
      {"wheeltap", about("sid", info, parsed.file)},
      {"title", sid_case.title},
      {"notes", parsed.notes},
      {"answer", json(answer(findings))},
      {"models", model_table(findings)},
      {"log_bayes_factors", bayes_factors_report(findings)},
      {"parameters", parameter_tables(findings)},
      {"priors", priors_of(sid_case)},
      {"residuals", residuals_of(sid_case)},
      {"unknowns", sid_unknowns_of(findings)},
      {"fit", fit_report(findings.fit_verdict)},
      {"fit_at_mean", fits_report(findings)},
      {"links", links_report(findings)},
      {"modes", modes_report(findings)},
      {"best_draw", best_draws(findings)},
      {"fit_at_best_draw", of_drawn(findings, [](const SidModelFinding& f,
                                                 std::size_t) { return fits_json(f.at_best); })},
      {"predictive", predictive_of(sid_case, findings)},
      {"data", data_of(parsed)},
      {"integration", integration_of(problem, findings)},
      {"diagnostics", diagnosed},
      {"cost", cost(findings.sampling)}};
  if (sid_case.discovery) {
    summary["terms"] = terms_report(findings);
    summary["discovery"] = discovery_report(sid_case, findings);
  }
  if (!sid_case.further.empty()) summary["further_records"] = further_of(sid_case, findings);
  if (!findings.evidence.empty()) summary["evidence"] = evidence_report(findings);
  return summary;
}

}  // namespace wheeltap::apps
