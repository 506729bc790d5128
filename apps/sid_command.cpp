#include "apps/sid_command.hpp"

#include <spdlog/spdlog.h>

#include <iostream>

#include "apps/run_files.hpp"
#include "apps/running.hpp"
#include "apps/several_ranks.hpp"
#include "apps/sid_posterior_file.hpp"
#include "apps/sid_summary.hpp"
#include "apps/sid_sweep.hpp"
#include "apps/sid_terminal.hpp"
#include "apps/simulation.hpp"
#include "apps/stored_run.hpp"
#include "apps/terminal.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

Report used_options(const SamplingOptions& options, const inference::Options& engine) {
  return {{"chains", options.chains},   {"warmup", engine.warmup},
          {"draws", engine.draws},      {"thin", engine.thin},
          {"search", options.searches}, {"prior_only", options.prior_only},
          {"quick", options.quick}};
}

}  // namespace

void require_room_for_truth(CaseFile& file, const CommonOptions& common) {
  validate_against_schema(file, "sid");
  require_affordable(file, Pointer("/truth/samples"), cost_of_truth(file), common);
}

RunCost cost_of_sid(const SidCaseFile& parsed, const CommonOptions& common,
                    const SamplingOptions& options) {
  const auto problem = explained(parsed, [&] { return make_sid_problem(parsed.sid); });
  SamplingOptions chosen = options;
  const inference::Options engine =
      affordable(engine_options(common, options), problem->seconds_a_likelihood);
  chosen.warmup = engine.warmup;
  chosen.draws = engine.draws;
  const inference::ModelSpace& space = problem->problem.space;
  Sampled sampled{
      .models = static_cast<double>(space.size()),
      .largest = static_cast<double>(space.max_dimension()),
      // 10 000 to 150 000 on the shipped cases, the repetition with finer steps included
      .explored = 40'000.0,
      .seconds_a_likelihood = problem->seconds_a_likelihood,
      .records = true};
  for (int m = 0; m < space.size(); ++m) sampled.dimensions += space[m].dimension;
  RunCost cost = cost_of_sampling(sampled, common, chosen);
  // The record and all that was made of it is there; searches shorten it to a half, a quarter, …,
  // each with simulators of its own.
  cost.bytes += 2.0 * bytes_held();
  const int all = problem->misfits.front().samples();
  const int few = options.quick ? samples_of_a_look(all, problem->seconds_a_likelihood) : all;
  if (few < all) {
    const std::shared_ptr<const inference::Problem> part = problem->problem.shortened(few);
    measure(cost, *part, engine, probe_seconds(common));
  } else {
    measure(cost, problem->problem, engine, probe_seconds(common));
  }
  return cost;
}

SidOutcome identify(const SidCaseFile& parsed, const CommonOptions& common,
                    const SamplingOptions& options, RunWatch& watch) {
  const SidRunOptions how = {
      .engine = engine_options(common, options),
      .sample = [&](const inference::Problem& problem,
                    const inference::Options& engine) { return watch.sample(problem, engine); },
      .doubt =
          [&](const std::vector<Remark>& doubts) {
            for (const Remark& doubt : doubts) watch.warn(sentence(doubt, {}));
          },
      .repeat =
          [&](const StepsRefined& refined) {
            watch.note(repeat_note(refined));
            watch.repeat(refined);
          },
      .refined = watch.refined()};
  SidOutcome out{.run = explained(parsed, [&] { return identification::run_sid(parsed.sid, how); }),
                 .predictive = {},
                 .findings = {}};
  const auto evidence =
      compute_evidence(out.run.problem->problem, evidence_methods(options.evidence),
                       out.run.engine.seed, common.threads, watch);
  if (!base::is_first_rank()) return out;
  out.predictive = predict(*out.run.problem, out.run.posterior);
  out.findings = sid_findings(out.run, out.predictive, evidence);
  return out;
}

std::optional<FinishedRun> sample_sid(std::shared_ptr<const SidCaseFile> parsed,
                                      const CommonOptions& common, const SamplingOptions& options,
                                      RunWatch& watch) {
  const auto out = std::make_shared<const SidOutcome>(identify(*parsed, common, options, watch));
  if (!base::is_first_rank()) return {};
  const std::uint64_t seed = out->run.engine.seed;
  Report summary = sid_summary(*parsed, *out->run.problem, out->findings,
                               {.seed = seed, .command_line = common.command_line});
  summary["wheeltap"]["asked"] = options_report(options);
  summary["wheeltap"]["options"] = used_options(options, out->run.engine);
  const std::string run = run_id(summary["wheeltap"], out->run.posterior);
  return FinishedRun{
      .summary = std::move(summary),
      .run = run,
      .posterior = {out, &out->run.posterior},
      .print = [parsed, out](std::ostream& to,
                             bool colour) { print_sid(to, *parsed, out->findings, colour); },
      .draws =
          [parsed, out, run, seed](const io::NetcdfWriter& file) {
            write_sid_posterior(file, run, *parsed, *out->run.problem, out->run.posterior,
                                out->predictive, seed);
          },
      .columns = [out] { return sid_columns(*out->run.problem, out->run.posterior); }};
}

void run_sid(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));  // refuse before anything runs
  const auto log = make_log(common.quiet);
  CaseFile file = read_case(common.case_path, common.overrides);
  if (file.json.contains("sweep")) return sweep_sid(std::move(file), common, options, *log);
  require_room_for_truth(file, common);
  const auto parsed = std::make_shared<const SidCaseFile>(parse_sid_case(std::move(file)));
  const RunCost cost = cost_of_sid(*parsed, common, options);
  require_affordable(parsed->file, Pointer(), cost, common);
  if (common.dry_run) return common.dry_run("run", cost);
  const Report asked = options_report(options);
  require_same_on_all_ranks("case", identity_of(parsed->file));
  if (common.resume) {
    const auto text = first_rank_says([&] {
      return finished_run(common.output, parsed->file, common.seed.value_or(1), "asked", asked);
    });
    if (text && !base::is_first_rank()) return;
    if (text) return print_finished(common.output, *text, *log);
  }
  std::optional<RunFiles> files;
  on_first_rank([&] {
    files.emplace(common.output);
    require_room(cost, common);
  });
  CheckpointFile checkpoint(common.output,
                            {.command = "sid",
                             .seed = common.seed.value_or(1),
                             .options = asked,
                             .case_json = parsed->file.json,
                             .inputs = parsed->file.inputs->json()},
                            common);
  TerminalWatch watch(common, *log);
  watch.keep(checkpoint);
  const auto run = sample_sid(parsed, common, options, watch);
  if (run) deliver(*run, *files, common.output, checkpoint);
}

void simulate_sid(const CommonOptions& common, CaseFile file) {
  if (common.output.extension() == ".json") {
    throw Failure(Exit::usage, "--output: " + common.output.string() +
                                   ": a simulated record is a table: name it .csv");
  }
  const auto [record, title, seed] = simulated_record(std::move(file), common);
  write_text(common.output,
             signals::record_csv(record, title + ", simulated by wheeltap " + WHEELTAP_VERSION +
                                             ", seed " + std::to_string(seed)));
  if (common.as_json)
    common.as_json(written_data(common.output, "simulated, seed " + std::to_string(seed),
                                static_cast<std::size_t>(record.samples()), "samples"));
  if (!common.quiet) {
    std::cout << record.samples() << " samples of " << record.columns.size()
              << " columns: " << io::printable(common.output.string()) << '\n';
  }
}

}  // namespace wheeltap::apps
