#include <iostream>
#include <optional>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/run_files.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"
#include "apps/runs/sid/sid_run.hpp"
#include "apps/runs/sid/sid_sweep.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// Which model explains a record: writes summary.json and posterior.nc into the output folder and
/// prints what was found. A case with a sweep is run once a value, and sweep.csv takes the place of
/// posterior.nc.
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

}  // namespace

Command sid_command() {
  return {.name = "sid",
          .summary = "which equation of motion a record obeys",
          .on_all_ranks = true,
          .case_kind = "sid",
          .add_options =
              [](CommandOptions& options) {
                options.add_run();
                options.add_limits();
                options.add_dry_run();
                options.add_resume(
                    "go on where an interrupted run or sweep stopped; print a finished one again");
              },
          .run = [](const Invocation& asked) { run_sid(asked.common, asked.sampling); }};
}

}  // namespace wheeltap::apps
