#include "apps/update_command.hpp"
#include "apps/checkpoint_file.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <iostream>
#include <sstream>

#include "apps/run_cost.hpp"
#include "apps/run_files.hpp"
#include "apps/running.hpp"
#include "apps/stored_run.hpp"
#include "apps/structure_case.hpp"
#include "apps/terminal.hpp"
#include "apps/update_case.hpp"
#include "apps/update_posterior_file.hpp"
#include "apps/update_summary.hpp"
#include "apps/update_terminal.hpp"
#include "identification/update_findings.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// What the library finds wrong, as a complaint about the case.
template <class Work>
auto complaining(const UpdateCaseFile& parsed, const Work& work) {
  try {
    return work();
  } catch (const fem::InvalidStructure& error) {
    refuse_structure(parsed.file, parsed.update.structure->nominal, error);
  } catch (const std::invalid_argument& error) {
    parsed.file.refuse(Pointer("/data"), error.what());
  }
}

RunCost cost_of_update(const UpdateProblem& problem, const CommonOptions& common,
                       const SamplingOptions& options) {
  const double d = problem.problem.space.max_dimension();
  RunCost cost =
      cost_of_sampling({.models = 1.0,
                        .dimensions = d,
                        .largest = d,
                        .predictions = static_cast<double>(problem.update_case.data.modes()),
                        .explored = 6'000.0,
                        .seconds_a_likelihood = problem.seconds_a_likelihood},
                       common, options);
  if (problem.states) cost.seconds_a_likelihood = problem.seconds_a_likelihood;
  return cost;
}

/// Of what comes before anything is known of the likelihood: solutions for the basis.
RunCost cost_of_basis(const UpdateCase& update_case) {
  const auto n = static_cast<double>(discretise(update_case.structure->nominal).size());
  return {.bytes = 8.0 * n * 800.0, .seconds = 60.0 * 1e-5 * n};
}

}  // namespace

void run_update(const CommonOptions& common, const SamplingOptions& options) {
  const auto methods = evidence_methods(options.evidence);  // refuse before anything runs
  const auto log = make_log(common.quiet);
  const UpdateCaseFile parsed = parse_update_case(read_case(common.case_path, common.overrides));
  const std::uint64_t seed = common.seed.value_or(1);
  require_affordable(parsed.file, Pointer("/structure"), cost_of_basis(parsed.update), common);
  if (common.resume && !common.dry_run) {
    if (const auto text =
            finished_run(common.output, parsed.file.json, seed, "options", options_report(options)))
      return print_finished(common.output, *text, *log);
  }
  ProgressBar bar(common.quiet);
  const auto problem = complaining(parsed, [&] {
    return make_update_problem(
        parsed.update, {.progress = [&](double done) { bar.show("reduced basis", done, ""); }});
  });
  bar.clear();
  const RunCost cost = cost_of_update(*problem, common, options);
  require_affordable(parsed.file, Pointer(), cost, common);
  if (common.dry_run) return print_estimate("run", cost);
  RunFiles files(common.output);
  CheckpointFile checkpoint(common.output,
                            {.command = "update",
                             .seed = seed,
                             .options = options_report(options),
                             .case_json = parsed.file.json},
                            common);
  const auto basis = problem->modes ? problem->modes->training()
                                    : fem::ParametricModes::Training{.complete = true};
  if (!basis.complete)
    log->info("reduced basis: {} modes stand for {} degrees of freedom, {:.2g} ms a solution",
              basis.basis, problem->modes->structure().nominal().size(),
              1e3 * problem->seconds_a_likelihood);
  if (basis.beyond > 0)
    log->warn(
        "{} of {} draws of the prior are beyond the basis and solved in full: this may take "
        "long",
        basis.beyond, basis.points);
  const StopOnInterrupt stop;
  const inference::Posterior posterior =
      run_engine(problem->problem, engine_options(common, options), common.case_path, common.quiet,
                 checkpoint);
  const UpdateFindings findings = update_findings(
      *problem, posterior, compute_evidence(problem->problem, methods, seed, common.threads, *log),
      seed);
  Report summary = update_summary(parsed, *problem, findings,
                                  {.seed = seed, .command_line = common.command_line});
  summary["wheeltap"]["options"] = options_report(options);
  std::ostringstream text;
  print_update(text, parsed, findings, false);
  const std::string run = run_id(summary["wheeltap"], posterior);
  const auto failed = files.keep(std::move(summary), text.str(), run, [&] {
    return update_posterior_file(run, parsed, *problem, posterior, seed);
  });
  print_update(std::cout, parsed, findings, colour_wanted());
  if (failed) throw *failed;
  say_what_goes_on(checkpoint, posterior.stopped_early);
  if (!posterior.stopped_early) checkpoint.remove();
  print_results(common.output, findings.sampling.verdict.converged);
}

void simulate_update(const CommonOptions& common, CaseFile file) {
  if (common.output.extension() != ".json")
    throw Failure(Exit::usage, "--output: " + common.output.string() +
                                   ": simulated modes are written as a complete case: name it "
                                   ".json");
  const UpdateCaseFile parsed = parse_update_case(std::move(file), UpdateNeeds::truth, common.seed);
  const ModalData& data = parsed.update.data;
  Json json = parsed.file.json;
  Json& out = json["data"];
  for (const char* key : {"file", "columns", "row"}) out.erase(key);
  out["frequencies"] = data.frequencies_hz;
  const Json& truth = json["truth"];
  if (!out.contains("cov")) out["cov"] = truth.at("cov");
  if (data.has_shapes()) {
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < data.shapes.rows(); ++i)
      rows.push_back(std::vector<double>(data.shapes.row(i).begin(), data.shapes.row(i).end()));
    out["shapes"] = rows;
    if (!out.contains("shape_sd")) out["shape_sd"] = truth.at("shape_sd");
  } else {
    out.erase("shapes");
  }
  json.erase("truth");
  write_text(common.output, json.dump(2) + "\n");
  if (!common.quiet)
    std::cout << data.modes() << " modes (" << data.origin
              << "): " << io::printable(common.output.string()) << '\n';
}

}  // namespace wheeltap::apps
