#include "apps/runs/problem_run.hpp"

#include <algorithm>

#include "apps/results/posterior_file.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/running.hpp"
#include "inference/diagnosis/verdict.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

void write_problem_posterior(const io::NetcdfWriter& file, const std::string& run,
                             const ProblemFile& parsed, const inference::Posterior& posterior) {
  const std::vector<DrawColumn> columns = parameter_columns(posterior);
  file.about(WHEELTAP_VERSION, run);
  file.text(file.root(), NC_GLOBAL, "title", parsed.title);
  write_draws(file, posterior, columns);
  write_sample_stats(file, posterior, columns[0]);
}

void print(std::ostream& out, bool colour, const ProblemFile& parsed, const Findings& findings) {
  const Page page{out, colour};
  page.heading(parsed.title);
  print_answer(page, answer(findings));
  const bool several = findings.models.size() > 1;
  if (several) {
    page.heading("Which model?");
    print_models(page, findings.models);
  }
  for (const ModelFinding& model : findings.models) {
    if (model.probability() < kWorthPrinting || model.parameters.empty()) continue;
    print_condition(page, model, several);
    std::vector<std::vector<std::string>> rows = {{"parameter", "mean", "sd", "95 % interval"}};
    for (const ParameterFinding& p : model.parameters) {
      const Marginal& e = p.estimate;
      rows.push_back({p.unknown.with_unit(), resolved(e.mean, e.width()), number_or_dash(e.sd, 2),
                      resolved(e.q2_5, e.width()) + " to " + resolved(e.q97_5, e.width())});
    }
    page.table(rows);
  }
  print_evidence(page, findings);
  print_closing(page, findings, warnings(findings, {}), "model");
}

/// Calls a function for a parameter in every draw of every model with this parameter.
template <class Visit>
void for_each_of(inference::Posterior& posterior, const std::string& name, const Visit& visit) {
  const auto& table = posterior.space->parameters();
  const auto number =
      static_cast<int>(std::ranges::find(table, name, &inference::Parameter::name) - table.begin());
  const auto width = static_cast<std::size_t>(posterior.dimension);
  for (auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const auto& own = (*posterior.space)[chain.model[i]].parameters;
      const auto at = std::ranges::find(own, number);
      if (at != own.end())
        visit(chain.theta[i * width + static_cast<std::size_t>(at - own.begin())]);
    }
  }
}

/// Replaces the draws of u by the draws x(u).
void tell_by_quantiles(inference::Posterior& posterior, const QuantilePrior& prior) {
  std::vector<double> values;
  for_each_of(posterior, prior.name, [&](double u) { values.push_back(u); });
  prior.quantiles(values);
  std::size_t next = 0;
  for_each_of(posterior, prior.name, [&](double& x) { x = values[next++]; });
}

}  // namespace

ProblemFile parse_problem(CaseFile file) {
  validate_against_schema(file, "sample");
  const Pointer models("/models");
  const Json& json = file.json;
  std::vector<inference::Parameter> table;
  std::vector<inference::ModelSpace::ListedModel> listed;
  std::vector<Json> written;  // the table's priors
  for (std::size_t m = 0; m < json["models"].size(); ++m) {
    const Json& model = json["models"][m];
    listed.push_back({.name = model.at("name").get<std::string>(),
                      .weight = model.value("prior", 1.0),
                      .parameters = model.at("order").get<std::vector<std::string>>()});
    for (const std::string& name : listed.back().parameters) {
      const Pointer where = models / m / "parameters" / name;
      if (!json.contains(where)) file.refuse(models / m / "order", "names no parameter " + name);
      const auto known = std::ranges::find(table, name, &inference::Parameter::name);
      if (known == table.end()) {
        table.push_back({name, parse_prior(file, where)});
        written.push_back(json.at(where));
      } else if (written[static_cast<std::size_t>(known - table.begin())] != json.at(where)) {
        file.refuse(where,
                    "has another prior in an earlier model: parameters with the same name are "
                    "the same parameter and need the same prior");
      }
    }
  }
  try {
    const auto space = std::make_shared<const inference::ModelSpace>(
        inference::ModelSpace::of_models(std::move(table), listed));
    std::string title = json.value("title", "Which model?");
    return {.file = std::move(file), .title = std::move(title), .space = space};
  } catch (const std::invalid_argument& error) {
    file.refuse(models, error.what());
  }
}

FinishedRun sample_problem(std::shared_ptr<const ProblemFile> parsed,
                           const inference::Problem& problem, const CommonOptions& common,
                           const SamplingOptions& options, RunWatch& watch,
                           const std::vector<QuantilePrior>& by_quantiles) {
  const auto methods = evidence_methods(options.evidence);
  const std::uint64_t seed = common.seed.value_or(1);
  inference::Posterior drawn = watch.sample(problem, engine_options(common, options));
  const auto evidence = compute_evidence(problem, methods, seed, common.threads, watch);
  const inference::Verdict verdict = inference::judge(drawn);
  Findings made = run_findings(drawn, verdict, seed);
  if (!by_quantiles.empty()) {
    for (const QuantilePrior& prior : by_quantiles) tell_by_quantiles(drawn, prior);
    Findings told = run_findings(drawn, verdict, seed);
    // The overlap of x with its prior equals the overlap of u.
    for (std::size_t m = 0; m < told.models.size(); ++m)
      for (std::size_t i = 0; i < told.models[m].parameters.size(); ++i)
        told.models[m].parameters[i].prior_overlap = made.models[m].parameters[i].prior_overlap;
    made = std::move(told);
  }
  const auto posterior = std::make_shared<const inference::Posterior>(std::move(drawn));
  conclude(made, *posterior->space, evidence);
  const auto findings = std::make_shared<const Findings>(std::move(made));
  Report priors = Report::object();
  for (const auto& parameter : posterior->space->parameters())
    priors[parameter.name] = parameter.prior.describe();
  for (const QuantilePrior& prior : by_quantiles) priors[prior.name] = "by its quantile function";
  Report summary = {
      {"wheeltap",
       about("sample", {.seed = seed, .command_line = common.command_line}, parsed->file)},
      {"title", parsed->title},
      {"answer", json(answer(*findings))},
      {"models", model_table(*findings)},
      {"parameters", parameter_tables(*findings)},
      {"priors", priors},
      {"diagnostics", diagnostics(*findings, warnings(*findings, {}))},
      {"cost", cost(findings->sampling)}};
  if (!findings->evidence.empty()) summary["evidence"] = evidence_report(*findings);
  summary["wheeltap"]["options"] = options_report(options);
  const std::string run = run_id(summary["wheeltap"], *posterior);
  return {
      .summary = std::move(summary),
      .run = run,
      .posterior = posterior,
      .print = [parsed, findings](std::ostream& out,
                                  bool colour) { apps::print(out, colour, *parsed, *findings); },
      .draws =
          [parsed, posterior, run](const io::NetcdfWriter& file) {
            write_problem_posterior(file, run, *parsed, *posterior);
          },
      .columns = [posterior] { return parameter_columns(*posterior); }};
}

}  // namespace wheeltap::apps
