#include <chrono>
#include <iostream>
#include <optional>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/results/damage_summary.hpp"
#include "apps/results/damage_terminal.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/damage_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/run_files.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

// States that do not fit their structure show where it is first solved.
RunCost explained_cost(const DamageCaseFile& parsed, const CommonOptions& common,
                       const SamplingOptions& options) {
  try {
    return cost_of_damages(parsed.damage, common, options);
  } catch (const fem::InvalidStructure& error) {
    parsed.refuse(InvalidInput(InvalidInput::Part::beam, error.what()));
  } catch (const std::invalid_argument& error) {
    parsed.refuse(InvalidInput(InvalidInput::Part::data, error.what()));
  }
}

// By a likelihood that is solved, unless that means to ask a model of someone else's, to train an
// emulator, or to prepare for long.
RunCost measured(RunCost cost, const std::shared_ptr<const DamageCaseFile>& parsed,
                 const CommonOptions& common, const SamplingOptions& options, spdlog::logger& log) {
  constexpr double kLongPreparation = 20.0;  // seconds
  if (parsed->outside || parsed->damage.emulator || cost.preparation > kLongPreparation)
    return cost;
  TerminalWatch watch(common, log);
  const auto began = std::chrono::steady_clock::now();
  const auto problem = prepare_damage(*parsed, common, watch);
  cost.preparation =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  measure(cost, problem->problem, engine_options(common, options), probe_seconds(common));
  return cost;
}

/// Writes summary.json and posterior.nc into the output folder and prints what was found. With
/// `resume`, a folder that holds a finished run of the same case and options is printed again
/// instead.
void run_damage(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));  // refuse before anything runs
  const auto log = make_log(common.quiet);
  const auto parsed = std::make_shared<const DamageCaseFile>(
      parse_damage_case(read_case(common.case_path, common.overrides)));
  const std::uint64_t seed = common.seed.value_or(1);
  const RunCost tables = cost_of_tables(parsed->damage);
  require_affordable(parsed->file, Pointer("/predictor"), tables, common);
  const RunCost cost = explained_cost(*parsed, common, options);
  require_affordable(parsed->file, Pointer(), cost, common);
  if (common.dry_run) {
    if (tables.likelihoods > 0.0) common.dry_run("table", tables);
    return common.dry_run("run", measured(cost, parsed, common, options, *log));
  }
  require_same_on_all_ranks("case", identity_of(parsed->file));
  if (common.resume) {
    const auto text = first_rank_says([&] {
      return finished_run(common.output, parsed->file, seed, "options", options_report(options));
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
                            {.command = "damage",
                             .seed = seed,
                             .options = options_report(options),
                             .case_json = parsed->file.json,
                             .inputs = parsed->file.inputs->json()},
                            common);
  TerminalWatch watch(common, *log);
  watch.keep(checkpoint);
  const auto problem = prepare_damage(*parsed, common, watch);
  if (problem->emulator && !common.quiet) {
    print_emulator(std::cout, emulator_finding(*problem->emulator, parsed->damage.data.sd_hz),
                   colour_wanted(), false);
  }
  const auto run = sample_damage(parsed, problem, common, options, watch);
  if (run) deliver(*run, *files, common.output, checkpoint);
}

}  // namespace

Command damage_command() {
  return {.name = "damage",
          .summary = "how many damages, where, how bad",
          .on_all_ranks = true,
          .case_kind = "damage",
          .add_options =
              [](CommandOptions& options) {
                options.add_run();
                options.add_permissions();
                options.add_limits();
                options.add_dry_run();
                options.add_resume(
                    "go on where an interrupted run stopped; print a finished one again");
              },
          .run = [](const Invocation& asked) { run_damage(asked.common, asked.sampling); }};
}

}  // namespace wheeltap::apps
