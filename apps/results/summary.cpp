#include "apps/results/summary.hpp"

#include <cmath>
#include <fstream>

#include "apps/text/fit_words.hpp"
#include "apps/text/verdict_words.hpp"
#include "base/parallel.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// A list of numbers; null for numbers that are not finite.
Report numbers(const std::vector<double>& list) {
  Report out = Report::array();
  for (const double x : list) out.push_back(finite(x));
  return out;
}

Report interval_json(const Interval& i) {
  return {{"mean", i.mean}, {"sd", i.sd},   {"q2.5", i.q2_5},  {"q5", i.q5},
          {"q50", i.q50},   {"q95", i.q95}, {"q97.5", i.q97_5}};
}

}  // namespace

Report json(const Marginal& e) {
  return {{"mean", e.mean},
          {"sd", e.sd},
          {"q2.5", e.q2_5},
          {"q50", e.q50},
          {"q97.5", e.q97_5},
          {"mode", e.mode},
          {"ess_bulk", finite(e.ess_bulk)},
          {"ess_tail", finite(e.ess_tail)},
          {"rhat", finite(e.rhat)},
          {"mcse_mean", finite(e.mcse_mean)},
          {"mcse_sd", finite(e.mcse_sd)}};
}

Report json(const BetweenWindows& between) {
  Report out = interval_json(between.next);
  out["whole"] = between.whole ? interval_json(*between.whole) : Report();
  out["scatter"] = {{"times_own_interval", between.scatter.ratio},
                    {"p_value", between.scatter.p_value}};
  out["use"] = between.scatters() ? "windows" : "run";
  out["windows"] = {{"value", numbers(between.value)}, {"sd", numbers(between.sd)}};
  return out;
}

Report json(const std::vector<ParameterFinding>& parameters) {
  Report table = Report::object();
  for (const ParameterFinding& p : parameters) {
    Report& row = table[p.unknown.label] = json(p.estimate);
    if (p.between_windows) row["between_windows"] = json(*p.between_windows);
    if (std::isfinite(p.prior_overlap)) row["prior_overlap"] = p.prior_overlap;
  }
  return table;
}

Report model_table(const Findings& findings) {
  Report table = Report::array();
  for (const ModelFinding& model : findings.models) {
    const inference::ModelStanding& s = model.standing;
    Report row = {{"name", model.name},
                  {"prior", model.prior},
                  {"probability", s.probability},
                  {"mcse", finite(s.mcse)},
                  {"visited", s.visited},
                  {"proposed", s.proposed},
                  {"entered", s.entered},
                  {"log_evidence", finite(s.log_evidence)},
                  {"log_evidence_se", finite(s.log_evidence_se)},
                  {"basis", s.basis == inference::Basis::draws ? "draws" : "evidence"}};
    if (s.passed_over) row["passed_over"] = true;
    const std::string told = told_in_full(findings, model) ? told_by_evidence(model) : "";
    if (!told.empty()) row["told"] = told;
    table.push_back(std::move(row));
  }
  return table;
}

Report parameter_tables(const Findings& findings) {
  Report tables = Report::object();
  for (const ModelFinding& model : findings.models) {
    if (model.drawn() && told_in_full(findings, model)) {
      tables[model.name] = json(model.parameters);
    }
  }
  return tables;
}

Report diagnostics(const Findings& findings, const std::vector<std::string>& warnings) {
  const Sampling& sampling = findings.sampling;
  const inference::Verdict& verdict = sampling.verdict;
  Report rhats = Report::object();
  for (const auto& [what, r] : verdict.rhats) rhats[what] = finite(r);
  const auto rate = [](long accepted, long proposed) {
    return proposed > 0 ? Report(static_cast<double>(accepted) / static_cast<double>(proposed))
                        : Report();
  };
  Report moves = Report::object();
  for (const auto& move : sampling.moves) {
    moves[move.name] = {{"proposed", move.proposed},
                        {"accepted", move.accepted},
                        {"rate", rate(move.accepted, move.proposed)}};
  }
  Report jumps = Report::object();
  for (std::size_t a = 0; a < sampling.jumps_proposed.size(); ++a) {
    for (std::size_t b = 0; b < sampling.jumps_proposed[a].size(); ++b) {
      const long proposed = sampling.jumps_proposed[a][b];
      const bool told =
          told_in_full(findings, findings.models[a]) && told_in_full(findings, findings.models[b]);
      if (a == b || proposed == 0 || !told) continue;
      jumps[findings.models[a].name + " -> " + findings.models[b].name] = {
          {"proposed", proposed},
          {"accepted", sampling.jumps_accepted[a][b]},
          {"rate", rate(sampling.jumps_accepted[a][b], proposed)}};
    }
  }
  Report notes = Report::array();
  for (const inference::Choice choice : sampling.choices) notes.push_back(in_words(choice));
  for (const int model : sampling.impossible_models)
    notes.push_back(impossible_in_words(findings.models[static_cast<std::size_t>(model)].name));
  const inference::ModelProbabilities& stationary = sampling.stationary;
  Report transitions = Report::array();
  const bool few = findings.models.size() <= kFewModelsTold;
  for (Eigen::Index a = 0; few && a < stationary.transitions.rows(); ++a) {
    const Eigen::VectorXd row = stationary.transitions.row(a);
    transitions.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return {
      {"converged", verdict.converged},
      {"not_established", in_words(verdict.not_established, *findings.space)},
      {"resolution", verdict.resolution},
      {"resolution_width",
       verdict.resolved_width > 0.0 ? Report(verdict.resolved_width) : Report()},
      {"resolution_words", resolution_in_words(verdict)},
      {"ess_model", finite(verdict.ess_model)},
      {"ess_log_posterior", finite(verdict.ess_log_posterior)},
      {"round_trips", sampling.count_round_trips},
      {"rhat_max", finite(verdict.rhat_max)},
      {"rhat", rhats},
      {"acceptance", {{"moves", moves}, {"models", jumps}}},
      {"transitions",
       {{"counts", transitions},
        {"stationary_mean", stationary.mean},
        {"stationary_sd", stationary.sd},
        {"effective_draws", finite(stationary.effective_draws)}}},
      {"ladder",
       {{"while_drawing", sampling.tempered_draws},
        {"round_trips", sampling.tempered_draws ? Report(sampling.ladder_round_trips) : Report()},
        {"barrier", sampling.barrier > 0.0 ? finite(sampling.barrier) : Report()}}},
      {"impossible", sampling.impossible},
      {"balanced", sampling.balanced},
      {"stopped_early", sampling.stopped_early},
      {"quick", sampling.quick},
      {"notes", notes},
      {"warnings", warnings}};
}

Report fit_report(const FitVerdict& verdict) {
  return {{"ok", verdict.ok()},
          {"r2", finite(verdict.r2)},
          {"p", finite(verdict.p)},
          {"why", in_words(verdict)}};
}

Report evidence_report(const Findings& findings) {
  Report out = Report::object();
  for (const EvidenceFinding& by : findings.evidence) {
    Report rows = Report::array();
    for (std::size_t m = 0; m < by.evidences.size(); ++m) {
      const inference::Evidence& e = by.evidences[m];
      Report doubts = Report::array();
      for (const inference::EvidenceWarning& w : e.warnings) doubts.push_back(describe(w));
      rows.push_back({{"model", findings.models[m].name},
                      {"log_evidence", finite(e.log_evidence)},
                      {"standard_error", finite(e.standard_error)},
                      {"log_bayes_factor", finite(e.log_evidence - by.evidences[0].log_evidence)},
                      {"probability", finite(by.implied.mean[m])},
                      {"probability_error", finite(by.implied.standard_error[m])},
                      {"likelihood_evaluations", e.likelihood_evaluations},
                      {"warnings", doubts}});
    }
    out[method_name(by.method)] = rows;
  }
  return out;
}

std::string machine() {
  std::string processor = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    processor = line.substr(colon + 2);
    break;
  }
  const int cores = base::thread_count(0);
  return processor + ", " + std::to_string(cores) + (cores == 1 ? " core" : " cores");
}

Report about(const std::string& command, const RunInfo& info, const CaseFile& file) {
  return {{"version", WHEELTAP_VERSION},
          {"command", command},
          {"command_line", info.command_line},
          {"seed", info.seed},
          {"machine", machine()},
          {"case_file", io::printable(file.path.string())},
          {"case", Report::parse(file.json.dump())},
          {"inputs", Report::parse(file.inputs->json().dump())}};
}

Report cost(const Sampling& sampling) {
  const inference::Calls& calls = sampling.calls;
  return {{"likelihood_evaluations", sampling.likelihood_evaluations},
          {"full_model_calls", sampling.full_evaluations},
          {"warmup_evaluations", sampling.warmup_evaluations},
          {"calls",
           {{"explore", calls.explore},
            {"tune", calls.tune},
            {"sample", calls.sample},
            {"evidence", calls.evidence},
            {"of_explore",
             {{"search", calls.search}, {"anneal", calls.anneal}, {"weigh", calls.weigh}}}}},
          {"wall_seconds", sampling.wall_seconds},
          {"chains", sampling.chains},
          {"draws_a_chain", sampling.draws},
          {"thin", sampling.thin},
          {"warmup_iterations_a_chain", sampling.warmup}};
}

}  // namespace wheeltap::apps
