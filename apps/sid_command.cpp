#include "apps/sid_command.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <optional>
#include <sstream>

#include "apps/evidence.hpp"
#include "apps/report/report.hpp"
#include "apps/running.hpp"
#include "apps/sid_posterior_file.hpp"
#include "apps/terminal.hpp"

namespace wheeltap::apps {
namespace {

/// What the engine spends by default, in likelihoods (reversible_jump.cpp): enough for hard
/// problems, too much for records that take milliseconds.
constexpr double kDefaultWarmup = 70'000;  ///< a chain
constexpr double kDefaultDraws = 25'000;   ///< a chain, four iterations each
constexpr double kAffordableSeconds = 60.0;
constexpr double kFewestDraws = 3'000;
constexpr double kFewestWarmup = 6'000;

/// What repeated runs aim at (step_error), and how many there may be.
constexpr double kWantedStepError = 0.1;
constexpr int kMostRepeats = 2;
constexpr int kMostRefinement = 16;  // of the step limit, in one of them

inference::Options engine_options(const CommonOptions& common, const SamplingOptions& options,
                                  double seconds_a_likelihood, bool balance) {
  inference::Options engine;
  engine.seed = common.seed.value_or(1);
  engine.chains = options.chains;
  engine.threads = common.threads;
  engine.prior_only = options.prior_only;
  engine.warmup = options.warmup;
  engine.draws = options.draws;
  engine.searches = options.searches;
  engine.balance = balance;
  // Likelihoods that each chain can have on two cores, whatever this machine has: threads never
  // change a result.
  const double affordable = kAffordableSeconds * 2.0 / options.chains / seconds_a_likelihood;
  if (options.prior_only || kDefaultWarmup + 4.0 * kDefaultDraws <= affordable) return engine;
  engine.thin = 1;
  if (engine.warmup == 0) {
    engine.warmup = static_cast<int>(std::clamp(0.5 * affordable, kFewestWarmup, kDefaultWarmup));
  }
  if (engine.draws == 0) {
    engine.draws = static_cast<int>(std::clamp(0.5 * affordable, kFewestDraws, kDefaultDraws));
  }
  return engine;
}

Report options_report(const SamplingOptions& options, const inference::Options& engine) {
  return {{"chains", options.chains},   {"warmup", engine.warmup},
          {"draws", engine.draws},      {"thin", engine.thin},
          {"search", options.searches}, {"prior_only", options.prior_only}};
}

struct Run {
  std::unique_ptr<const SidProblem> problem;
  inference::Posterior posterior;
  SidPredictive predictive;
  Report summary;
};

/// How to integrate where the steps were too long for the noise, or none where they were not: by
/// series where a chain's laws let them, else by shorter steps, whose error goes with their fourth
/// power.
std::optional<dynamics::SimulatorOptions> better_integration(
    const SidProblem& problem, const inference::Posterior& posterior) {
  std::vector<double> visits(static_cast<std::size_t>(problem.problem.space.size()));
  const std::vector<double> weights = model_weights(posterior);
  for (const auto& chain : posterior.chains) {
    for (const int m : chain.model) {
      visits[static_cast<std::size_t>(m)] += weights[static_cast<std::size_t>(m)];
    }
  }
  const double all = std::accumulate(visits.begin(), visits.end(), 0.0);
  dynamics::SimulatorOptions better = problem.sid_case.integration;
  bool needed = false;
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    if (20.0 * visits[static_cast<std::size_t>(m)] < all) continue;
    const double error = step_error(problem, posterior, m).value_or(0.0);
    if (error <= kLargestStepError) continue;
    needed = true;
    const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
    const dynamics::Simulator& simulator = misfit.simulator();
    const dynamics::SimulatorOptions& now = problem.sid_case.integration;
    if (dynamics::has_series(simulator.chain()) && !now.prefer_series) {
      better.prefer_series = true;
      continue;
    }
    // Steps come in few different numbers: halve the limit until there are enough of them.
    const auto theta = posterior_mean(problem, posterior, m);
    const double enough = simulator.substeps(theta) * std::pow(error / kWantedStepError, 0.25);
    int factor = 2;
    while (factor < kMostRefinement && simulator.refined(factor).substeps(theta) < enough)
      factor *= 2;
    better.step_limit = std::min(better.step_limit, now.step_limit / factor);
  }
  return needed ? std::optional(better) : std::nullopt;
}

Run run_once(SidCase sid_case, const CommonOptions& common, const SamplingOptions& options,
             spdlog::logger& log) {
  const bool steps_given = sid_case.file.json.contains("integration");
  Run run{.problem = make_sid_problem(std::move(sid_case)),
          .posterior = {},
          .predictive = {},
          .summary = {}};
  inference::Options engine;
  std::string note;
  for (int repeats = 0;; ++repeats) {
    engine = engine_options(common, options, run.problem->seconds_a_likelihood,
                            run.problem->sid_case.balance);
    run.posterior = run_engine(run.problem->problem, engine, common.case_path, common.quiet);
    if (!note.empty()) run.posterior.notes.push_back(note);
    if (steps_given || options.prior_only || run.posterior.stopped_early) break;
    const auto better = better_integration(*run.problem, run.posterior);
    if (!better || repeats == kMostRepeats) break;
    note =
        "The integrator's steps were too long for the noise of this record, so the run was "
        "repeated with " +
        (better->prefer_series && !run.problem->sid_case.integration.prefer_series
             ? "Taylor series."
             : "a step limit of " + significant(better->step_limit, 2) + ".");
    log.info(note);
    SidCase finer = run.problem->sid_case;
    finer.integration = *better;
    run.problem = make_sid_problem(std::move(finer));
  }
  const auto also = compute_evidence(run.problem->problem, options.evidence,
                                     common.seed.value_or(1), common.threads, log);
  run.predictive = predict(*run.problem, run.posterior);
  run.summary = summarise_sid(*run.problem, run.posterior, run.predictive, also,
                              {.seed = engine.seed, .command_line = common.command_line});
  run.summary["wheeltap"]["options"] = options_report(options, engine);
  return run;
}

std::string csv_number(const Report& value) {
  return value.is_number() ? significant(value.get<double>(), 8) : "";
}

void run_sweep(const CaseFile& file, const CommonOptions& common, const SamplingOptions& options,
               spdlog::logger& log) {
  const Json sweep = file.json["sweep"];
  Pointer path;
  try {
    path = Pointer(sweep["path"].get<std::string>());
  } catch (const Json::exception&) {
    file.refuse(Pointer("/sweep/path"), "must be a JSON pointer, e.g. \"/record/samples/1\"");
  }
  if (!file.json.contains(path)) {
    file.refuse(Pointer("/sweep/path"), "leads nowhere in this case");
  }
  // All of them first, so that a mistake in the last does not cost the runs before it.
  std::vector<SidCase> cases;
  for (const Json& value : sweep["values"]) {
    CaseFile one = file;
    one.json.erase("sweep");
    one.json[path] = value;
    cases.push_back(parse_sid_case(std::move(one)));
  }
  io::AtomicFile table_file(common.output / "sweep.csv");
  io::AtomicFile summary_file(common.output / "summary.json");
  Report rows = Report::array();
  std::string table;
  std::vector<std::vector<std::string>> printed;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Json value = sweep["values"][i];
    Run run = run_once(std::move(cases[i]), common, options, log);
    const Report& s = run.summary;
    Report row = {{"value", Report::parse(value.dump())},
                  {"models", s["models"]},
                  {"log_bayes_factors", s["log_bayes_factors"]},
                  {"parameters", s["parameters"]},
                  {"fit", s["fit"]},
                  {"converged", s["diagnostics"]["converged"]},
                  {"not_established", s["diagnostics"]["not_established"]},
                  {"resolution", s["diagnostics"]["resolution"]},
                  {"warnings", s["diagnostics"]["warnings"]},
                  {"cost", s["cost"]}};
    if (s.contains("evidence")) row["evidence"] = s["evidence"];
    std::vector<std::string> header = {"value"}, cells = {value.dump()};
    const auto add = [&](const std::string& name, const std::string& cell) {
      header.push_back(name);
      cells.push_back(cell);
    };
    for (const auto& m : s["models"]) {
      add("P(" + m["name"].get<std::string>() + ")",
          m["mcse"].is_number() ? csv_number(m["probability"]) : "");
      add("mcse", csv_number(m["mcse"]));
      add("basis", m["basis"]);
    }
    for (const auto& b : s["log_bayes_factors"]) {
      add("ln B(" + b["model"].get<std::string>() + ":" + b["against"].get<std::string>() + ")",
          csv_number(b["log_bayes_factor"]));
      add("mcse", csv_number(b["mcse"]));
    }
    if (s.contains("evidence")) {
      for (const auto& [method, models] : s["evidence"].items()) {
        for (std::size_t m = 1; m < models.size(); ++m) {
          add(method + " ln B(" + models[m]["model"].get<std::string>() + ")",
              csv_number(models[m]["log_bayes_factor"]));
          const auto& se = models[m]["standard_error"];
          add("se",
              se.is_number() && models[0]["standard_error"].is_number()
                  ? significant(
                        std::hypot(se.get<double>(), models[0]["standard_error"].get<double>()), 4)
                  : "");
        }
      }
    }
    add("converged", s["diagnostics"]["converged"].get<bool>() ? "1" : "0");
    const auto line = [](const std::vector<std::string>& list) {
      std::string text;
      for (const auto& cell : list) text += (text.empty() ? "" : ",") + cell;
      return text + "\n";
    };
    if (i == 0) {
      table = "# " + run.problem->sid_case.title + "; value of " +
              sweep["path"].get<std::string>() + "\n" + line(header);
      std::cout << '\n'
                << run.problem->sid_case.title << "\nSweep of " << sweep["path"].get<std::string>()
                << "\n"
                << line(header);
    }
    table += line(cells);
    std::cout << line(cells);
    const auto& open = s["diagnostics"]["not_established"];
    for (const auto& sentence : open) std::cout << "# " << sentence.get<std::string>() << '\n';
    for (const auto& m : s["models"]) {
      const auto name = m["name"].get<std::string>();
      const bool said = std::ranges::any_of(open, [&](const auto& sentence) {
        return sentence.template get<std::string>().find("'" + name + "'") != std::string::npos;
      });
      const std::string told = told_by_evidence(m);
      if (!told.empty() && !said) std::cout << "# " << name << ": " << told << '\n';
    }
    std::cout << std::flush;
    rows.push_back(std::move(row));
  }
  const Report summary = {
      {"wheeltap",
       about("sid", {.seed = common.seed.value_or(1), .command_line = common.command_line}, file)},
      {"sweep", {{"path", sweep["path"].get<std::string>()}, {"rows", rows}}}};
  write_text(table_file, table);
  write_text(summary_file, summary.dump(1) + "\n");
  table_file.commit();
  summary_file.commit();
  write_report(common.output);
  std::cout << "Results: " << (common.output / "sweep.csv").string() << " (the table), "
            << (common.output / "summary.json").string() << " (all numbers)\n";
}

}  // namespace

void run_sid(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));
  const auto log = make_log(common.quiet);
  CaseFile file = read_case(common.case_path, common.overrides);
  if (file.json.contains("sweep")) {
    validate_against_schema(file, "sid");
    make_output_folder(common.output);
    run_sweep(file, common, options, *log);
    return;
  }
  SidCase parsed = parse_sid_case(std::move(file));
  make_output_folder(common.output);
  // Reserve the names first: a run that cannot be kept should not start.
  io::AtomicFile posterior_file(common.output / "posterior.nc");
  io::AtomicFile summary_file(common.output / "summary.json");
  const Run run = run_once(std::move(parsed), common, options, *log);
  write_sid_posterior_file(posterior_file.temporary(), *run.problem, run.posterior, run.predictive,
                           common.seed.value_or(1));
  write_text(summary_file, run.summary.dump(1) + "\n");
  posterior_file.commit();
  summary_file.commit();
  write_report(common.output);
  print_sid(std::cout, run.summary, colour_wanted());
  std::cout << "Results: " << (common.output / "summary.json").string() << " (numbers), "
            << (common.output / "posterior.nc").string() << " (every draw), "
            << (common.output / "report.html").string() << " (pictures)\n";
  if (!run.summary["diagnostics"]["converged"].get<bool>()) {
    std::cout << "NOT CONVERGED: do not trust these numbers yet.\n";
  }
}

void simulate_sid(const CommonOptions& common, CaseFile file) {
  const SidCase sid_case = parse_sid_case(std::move(file), SidNeeds::models);
  const std::uint64_t seed = common.seed.value_or(sid_case.truth ? sid_case.truth->seed : 1);
  const signals::Record record = simulate_record(sid_case, seed);
  write_text(common.output,
             record_csv(record, sid_case.title + ", simulated by wheeltap " + WHEELTAP_VERSION +
                                    ", seed " + std::to_string(seed)));
  if (!common.quiet) {
    std::cout << record.samples() << " samples of " << record.columns.size()
              << " columns: " << common.output.string() << '\n';
  }
}

}  // namespace wheeltap::apps
