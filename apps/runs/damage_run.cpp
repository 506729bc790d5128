#include "apps/runs/damage_run.hpp"

#include "apps/remote/outside_model.hpp"
#include "apps/results/damage_summary.hpp"
#include "apps/results/damage_terminal.hpp"
#include "apps/results/posterior_file.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/runs/running.hpp"
#include "base/parallel.hpp"
#include "identification/structural/damage/damage_plausibility.hpp"

namespace wheeltap::apps {

using namespace identification;

std::shared_ptr<const DamageProblem> prepare_damage(const DamageCaseFile& parsed,
                                                    const CommonOptions& common, RunWatch& watch) {
  const auto show = [&](int count, Eigen::Index done, Eigen::Index total) {
    watch.show("table", static_cast<double>(done) / static_cast<double>(total),
               std::to_string(total) + (parsed.outside ? " runs, " : " FE runs, ") +
                   std::to_string(count) + (count == 1 ? " damage" : " damages"));
  };
  DamageProblemOptions options = {.threads = base::thread_count(common.threads),
                                  .table_progress = show};
  if (parsed.outside) {
    if (base::ranks() != nullptr)
      throw Failure(Exit::usage, "a predictor of one's own runs in one process, not under mpirun");
    options.outside = open_outside(parsed.file, *parsed.outside, parsed.damage.modes(), common);
  }
  std::shared_ptr<const DamageProblem> problem =
      explained(parsed, [&] { return make_damage_problem(parsed.damage, options); });
  watch.clear();
  return problem;
}

std::optional<FinishedRun> sample_damage(std::shared_ptr<const DamageCaseFile> parsed,
                                         std::shared_ptr<const DamageProblem> problem,
                                         const CommonOptions& common,
                                         const SamplingOptions& options, RunWatch& watch) {
  const auto methods = evidence_methods(options.evidence);
  const std::uint64_t seed = common.seed.value_or(1);
  for (const Remark& doubt : implausible(*problem)) watch.warn(sentence(doubt, {}));
  inference::Options engine = engine_options(common, options);
  engine.balance = problem->damage_case.balance;
  const auto posterior =
      std::make_shared<const inference::Posterior>(watch.sample(problem->problem, engine));
  const auto evidence = compute_evidence(problem->problem, methods, seed, common.threads, watch);
  if (!base::is_first_rank()) return {};
  const auto findings =
      std::make_shared<const DamageFindings>(damage_findings(*problem, *posterior, evidence, seed));
  Report summary =
      damage_summary(*parsed, *findings, {.seed = seed, .command_line = common.command_line});
  summary["wheeltap"]["options"] = options_report(options);
  if (parsed->outside)
    summary["predictor"] = outside_report(*parsed->outside, problem->program()->model());
  const std::string run = run_id(summary["wheeltap"], *posterior);
  return FinishedRun{
      .summary = std::move(summary),
      .run = run,
      .posterior = posterior,
      .print = [parsed, findings](std::ostream& out,
                                  bool colour) { print_damage(out, *parsed, *findings, colour); },
      .draws =
          [parsed, problem, posterior, run, seed](const io::NetcdfWriter& file) {
            write_posterior(file, run, *parsed, *problem, *posterior, seed);
          },
      .columns = [problem, posterior] { return damage_columns(*problem, *posterior); }};
}

}  // namespace wheeltap::apps
