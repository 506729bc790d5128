#include <chrono>
#include <iostream>

#include "apps/cases/damage_case.hpp"
#include "apps/remote/outside_model.hpp"
#include "apps/remote/served_case.hpp"
#include "apps/results/damage_summary.hpp"
#include "apps/results/damage_terminal.hpp"
#include "apps/results/posterior_file.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/running.hpp"
#include "base/parallel.hpp"
#include "base/ranks.hpp"
#include "identification/structural/damage/damage_cost.hpp"
#include "identification/structural/damage/damage_plausibility.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

class DamageRun final : public CaseRun {
 public:
  DamageRun(CaseFile file, const CommonOptions& common, const SamplingOptions& options)
      : CaseRun(common, options),
        parsed_(std::make_shared<const DamageCaseFile>(parse_damage_case(std::move(file)))) {}

  [[nodiscard]] const CaseFile& file() const override { return parsed_->file; }

  std::optional<RunCost> estimate() override {
    require_affordable(file(), Pointer("/predictor"), cost_of_tables(parsed_->damage), common());
    const RunCost cost = explained_cost();
    require_affordable(file(), Pointer(), cost, common());
    return cost;
  }

  void dry_run(const std::optional<RunCost>& cost, RunWatch& watch) override {
    const RunCost tables = cost_of_tables(parsed_->damage);
    if (tables.likelihoods > 0.0) common().dry_run("table", tables);
    CaseRun::dry_run(measured(cost.value(), watch), watch);
  }

  void prepare(RunWatch& watch) override {
    const auto show = [&](int count, Eigen::Index done, Eigen::Index total) {
      watch.show("table", static_cast<double>(done) / static_cast<double>(total),
                 std::to_string(total) + (parsed_->outside ? " runs, " : " FE runs, ") +
                     std::to_string(count) + (count == 1 ? " damage" : " damages"));
    };
    DamageProblemOptions how = {.threads = base::thread_count(common().threads),
                                .table_progress = show};
    if (parsed_->outside) {
      if (base::ranks() != nullptr)
        throw Failure(Exit::usage,
                      "an external predictor runs in one process: start it without mpirun");
      how.outside = open_outside(file(), *parsed_->outside, parsed_->damage.modes(), common());
    }
    problem_ = explained(*parsed_, [&] { return make_damage_problem(parsed_->damage, how); });
    watch.clear();
  }

  void print_preparation() const override {
    if (problem_->emulator && !common().quiet)
      print_emulator(std::cout, emulator_finding(*problem_->emulator, parsed_->damage.data.sd_hz),
                     colour_wanted(), false);
  }

  std::optional<FinishedRun> sample(RunWatch& watch) override;

  std::vector<ServedModel> served() override {
    return explained(*parsed_, [&] { return apps::served(problem_); });
  }

 private:
  // Cost of the run. The first solution of the structure also reports states that are invalid for
  // it.
  [[nodiscard]] RunCost explained_cost() const {
    try {
      return cost_of_damages(parsed_->damage, engine_options(common(), options()),
                             draws_in_memory(common()));
    } catch (const fem::InvalidStructure& error) {
      parsed_->refuse(InvalidInput(InvalidInput::Part::beam, error.what()));
    } catch (const std::invalid_argument& error) {
      parsed_->refuse(InvalidInput(InvalidInput::Part::data, error.what()));
    }
  }

  // Measures the run time of a likelihood evaluation. Omits the measurement if it requires an
  // external model, the training of an emulator or a long preparation.
  RunCost measured(RunCost cost, RunWatch& watch) {
    constexpr double kLongPreparation = 20.0;  // seconds
    if (parsed_->outside || parsed_->damage.emulator || cost.preparation > kLongPreparation)
      return cost;
    const auto began = std::chrono::steady_clock::now();
    prepare(watch);
    cost.preparation =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    measure(cost, problem_->problem, engine_options(common(), options()), probe_seconds(common()));
    return cost;
  }

  std::shared_ptr<const DamageCaseFile> parsed_;
  std::shared_ptr<const DamageProblem> problem_;
};

std::optional<FinishedRun> DamageRun::sample(RunWatch& watch) {
  for (const Remark& doubt : implausible(*problem_)) watch.warn(sentence(doubt, {}));
  inference::Options engine = engine_options(common(), options());
  engine.balance = problem_->damage_case.balance;
  const auto posterior =
      std::make_shared<const inference::Posterior>(watch.sample(problem_->problem, engine));
  const auto evidence = compute_evidence(problem_->problem, evidence_methods(options().evidence),
                                         seed(), common().threads, watch);
  if (!base::is_first_rank()) return {};
  const auto findings = std::make_shared<const DamageFindings>(
      damage_findings(*problem_, *posterior, evidence, seed()));
  Report summary =
      damage_summary(*parsed_, *findings, {.seed = seed(), .command_line = common().command_line});
  summary["wheeltap"]["options"] = options_report(options());
  if (parsed_->outside)
    summary["predictor"] = outside_report(*parsed_->outside, problem_->program()->model());
  const std::string run = run_id(summary["wheeltap"], *posterior);
  return FinishedRun{
      .summary = std::move(summary),
      .run = run,
      .posterior = posterior,
      .print = [parsed = parsed_, findings](
                   std::ostream& out,
                   bool colour) { print_damage(out, *parsed, *findings, colour); },
      .draws =
          [parsed = parsed_, problem = problem_, posterior, run,
           seed = seed()](const io::NetcdfWriter& to) {
            write_posterior(to, run, *parsed, *problem, *posterior, seed);
          },
      .columns = [problem = problem_, posterior] { return damage_columns(*problem, *posterior); }};
}

}  // namespace

std::unique_ptr<CaseRun> make_damage_run(CaseFile file, const CommonOptions& common,
                                         const SamplingOptions& options) {
  return std::make_unique<DamageRun>(std::move(file), common, options);
}

}  // namespace wheeltap::apps
