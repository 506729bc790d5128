#include <iostream>
#include <optional>

#include "apps/cases/update_case.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/run_files.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"
#include "apps/runs/update_run.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// The posterior of a structure's parameters from its measured modes: writes summary.json and
/// posterior.nc into the output folder and prints what was found.
void run_update(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));  // refuse before anything runs
  const auto log = make_log(common.quiet);
  const auto parsed = std::make_shared<const UpdateCaseFile>(
      parse_update_case(read_case(common.case_path, common.overrides)));
  const std::uint64_t seed = common.seed.value_or(1);
  require_affordable(parsed->file, Pointer("/structure"), cost_of_basis(*parsed), common);
  if (parsed->outside && common.dry_run) {
    if (const auto& front = parsed->outside->emulator) {
      const auto d = static_cast<int>(parsed->outside->order.size());
      common.dry_run("emulator", {.likelihoods = static_cast<double>(front->runs_for(d) +
                                                                     front->holdout_for(d))});
    }
    return common.dry_run("run", cost_of_outside(*parsed, common, options));
  }
  if (parsed->outside && base::ranks() != nullptr)
    throw Failure(Exit::usage, "a predictor of one's own runs in one process, not under mpirun");
  require_same_on_all_ranks("case", identity_of(parsed->file));
  if (common.resume && !common.dry_run) {
    const auto text = first_rank_says([&] {
      return finished_run(common.output, parsed->file, seed, "options", options_report(options));
    });
    if (text && !base::is_first_rank()) return;
    if (text) return print_finished(common.output, *text, *log);
  }
  TerminalWatch watch(common, *log);
  if (parsed->outside) on_first_rank([&] { claim_output_folder(common.output); });  // for answers
  const auto problem = prepare_update(*parsed, common, watch);
  const RunCost cost = cost_of_update(*problem, common, options);
  require_affordable(parsed->file, Pointer(), cost, common);
  if (common.dry_run) return common.dry_run("run", cost);
  std::optional<RunFiles> files;
  on_first_rank([&] {
    files.emplace(common.output);
    require_room(cost, common);
  });
  CheckpointFile checkpoint(common.output,
                            {.command = "update",
                             .seed = seed,
                             .options = options_report(options),
                             .case_json = parsed->file.json,
                             .inputs = parsed->file.inputs->json()},
                            common);
  watch.keep(checkpoint);
  const auto run = sample_update(parsed, problem, common, options, watch);
  if (run) deliver(*run, *files, common.output, checkpoint);
}

}  // namespace

Command update_command() {
  return {.name = "update",
          .summary = "a structure's parameters from its measured modes",
          .on_all_ranks = true,
          .case_kind = "update",
          .add_options =
              [](CommandOptions& options) {
                options.add_run();
                options.add_permissions();
                options.add_limits();
                options.add_dry_run();
                options.add_resume(
                    "go on where an interrupted run stopped; print a finished one again");
              },
          .run = [](const Invocation& asked) { run_update(asked.common, asked.sampling); }};
}

}  // namespace wheeltap::apps
