#include <iostream>
#include <memory>
#include <utility>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/explained.hpp"
#include "apps/results/planning/plan_summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/plan_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

/// Estimate of the run time on one core, without the check by the full engine.
RunCost cost_of_plan(const PlanCaseFile& parsed, const CommonOptions& common, int scenarios) {
  return {.seconds = explained(parsed, [&] {
            return identification::planning::estimate_seconds(
                parsed.plan,
                {.scenarios = scenarios, .seed = common.seed.value_or(1), .threads = 1});
          })};
}

void plan(const CommonOptions& common, PlanRunOptions options) {
  const PlanCaseFile parsed = parse_plan_case(read_case(common.case_path, common.overrides));
  check_plan_case(parsed, options.scenarios);
  if (common.dry_run)
    return common.dry_run("plan", cost_of_plan(parsed, common, options.scenarios));
  claim_output_folder(common.output);
  ProgressBar bar(common.quiet);
  options.progress = [&](const char* stage, double fraction) { bar.show(stage, fraction, ""); };
  const PlanRun run = run_plan(parsed, common, options);
  bar.clear();
  run.keep(common.output);
  if (common.as_json) return common.as_json(run.summary.dump(1));
  print_plan(std::cout, run.summary, colour_wanted());
  std::cout << "\nResults: " << io::printable((common.output / "summary.json").string())
            << "\nDamage case for the recommended design: "
            << io::printable((common.output / "damage.json").string())
            << "\nReport: " << io::printable((common.output / "report.html").string()) << std::endl;
}

}  // namespace

Command plan_command() {
  const auto how = std::make_shared<PlanRunOptions>();
  return {.name = "plan",
          .summary = "plan a modal test: which damage it can detect, and which sensors to use",
          .case_kind = "damage",
          .case_key = "plan",
          .check =
              [](CaseFile file) {
                check_plan_case(parse_plan_case(std::move(file)), PlanRunOptions().scenarios);
              },
          .add_options =
              [how](CommandOptions& options) {
                options.add_case();
                options.add_output(
                    "FOLDER", "folder of the results: summary.json, damage.json and report.html");
                options.add_json(kSummary);
                options.add_seed("seed of the simulated tests (default 1)");
                options.add_threads();
                options.add_dry_run();
                CLI::App& app = options.app();
                app.add_option(
                       "--scenarios", how->scenarios,
                       "number of simulated tests for each of the best designs (default: 100000)")
                    ->check(whole(1000, 10'000'000));
                app.add_option("--check", how->checks,
                               "number of simulated tests that Wheeltap also analyses by quick "
                               "runs of the full engine, as a check (default: 10)")
                    ->check(whole(0, 10'000));
              },
          .run = [how](const Invocation& asked) { plan(asked.common, *how); }};
}

}  // namespace wheeltap::apps
