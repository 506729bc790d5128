#include "apps/runs/case_run.hpp"

#include "apps/results/stored_run.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/run_files.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"

namespace wheeltap::apps {

void CaseRun::dry_run(const std::optional<RunCost>& cost, RunWatch& /*watch*/) {
  common_.dry_run("run", cost.value());
}

CaseFile case_to_sample(const CommonOptions& common, const SamplingOptions& options) {
  static_cast<void>(evidence_methods(options.evidence));  // throws before the run starts
  return read_case(common.case_path, common.overrides);
}

void run_case(CaseRun& run) {
  const CommonOptions& common = run.common();
  const auto log = make_log(common.quiet);
  std::optional<RunCost> cost = run.estimate();
  if (common.dry_run) {
    TerminalWatch watch(common, *log);
    return run.dry_run(cost, watch);
  }
  require_same_on_all_ranks("case", identity_of(run.file()));
  const Report options = options_report(run.options());
  if (common.resume) {
    const auto text = first_rank_says([&] {
      return finished_run(common.output, run.file(), run.seed(), run.options_key(), options);
    });
    if (text && !base::is_first_rank()) return;
    if (text) return print_finished(common.output, *text, *log);
  }
  TerminalWatch watch(common, *log);
  const bool prepared = !cost;
  if (prepared) {
    run.prepare(watch);
    cost = run.estimate();
  }
  std::optional<RunFiles> files;
  on_first_rank([&] {
    files.emplace(common.output);
    require_room(cost.value(), common);
  });
  CheckpointFile checkpoint(common.output,
                            {.command = run.file().json.at("kind").get<std::string>(),
                             .seed = run.seed(),
                             .options = options,
                             .case_json = run.file().json,
                             .inputs = run.file().inputs->json()},
                            common);
  watch.keep(checkpoint);
  if (!prepared) run.prepare(watch);
  run.print_preparation();
  const auto finished = run.sample(watch);
  if (finished) deliver(*finished, *files, common.output, checkpoint);
}

}  // namespace wheeltap::apps
