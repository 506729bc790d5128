#include "apps/runs/sid/sid_run.hpp"

#include "apps/remote/served_case.hpp"
#include "apps/results/sid_posterior_file.hpp"
#include "apps/results/sid_summary.hpp"
#include "apps/results/sid_terminal.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/running.hpp"
#include "base/ranks.hpp"
#include "identification/sid/sid_residuals.hpp"

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
  const inference::Options engine =
      affordable(engine_options(common, options), problem->seconds_a_likelihood);
  RunCost cost =
      cost_of_sampling({.largest = static_cast<double>(problem->problem.space.max_dimension())},
                       engine, draws_in_memory(common));  // time measured
  // The record and its derived data exist already. Searches use a half, a quarter, … of the record,
  // each with separate simulators.
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

namespace {

/// A run without preparation: estimate() already measures the run time of the likelihood.
class SidCaseRun final : public CaseRun {
 public:
  SidCaseRun(CaseFile file, const CommonOptions& common, const SamplingOptions& options)
      : CaseRun(common, options) {
    require_room_for_truth(file, common);
    parsed_ = std::make_shared<const SidCaseFile>(parse_sid_case(std::move(file)));
  }

  [[nodiscard]] const CaseFile& file() const override { return parsed_->file; }
  [[nodiscard]] const char* options_key() const override { return "asked"; }

  std::optional<RunCost> estimate() override {
    const RunCost cost = cost_of_sid(*parsed_, common(), options());
    require_affordable(file(), Pointer(), cost, common());
    return cost;
  }

  std::optional<FinishedRun> sample(RunWatch& watch) override;

  std::vector<ServedModel> served() override {
    SidCaseFile chosen = *parsed_;
    // Choose the residual orders that the case does not state, as in the first step of a run.
    choose_residuals(chosen.sid, seed(), common().threads);
    return explained(chosen, [&] {
      return apps::served(std::shared_ptr<const SidProblem>(make_sid_problem(chosen.sid)));
    });
  }

 private:
  std::shared_ptr<const SidCaseFile> parsed_;
};

std::optional<FinishedRun> SidCaseRun::sample(RunWatch& watch) {
  const auto out =
      std::make_shared<const SidOutcome>(identify(*parsed_, common(), options(), watch));
  if (!base::is_first_rank()) return {};
  const std::uint64_t seed = out->run.engine.seed;
  Report summary = sid_summary(*parsed_, *out->run.problem, out->findings,
                               {.seed = seed, .command_line = common().command_line});
  summary["wheeltap"]["asked"] = options_report(options());
  summary["wheeltap"]["options"] = used_options(options(), out->run.engine);
  const std::string run = run_id(summary["wheeltap"], out->run.posterior);
  return FinishedRun{
      .summary = std::move(summary),
      .run = run,
      .posterior = {out, &out->run.posterior},
      .print =
          [out](std::ostream& to, bool colour) {
            print_sid(to, out->run.problem->sid_case, out->findings, colour);
          },
      .draws =
          [parsed = parsed_, out, run, seed](const io::NetcdfWriter& to) {
            write_sid_posterior(to, run, *parsed, *out->run.problem, out->run.posterior,
                                out->predictive, seed);
          },
      .columns = [out] { return sid_columns(*out->run.problem, out->run.posterior); }};
}

}  // namespace

std::unique_ptr<CaseRun> make_sid_run(CaseFile file, const CommonOptions& common,
                                      const SamplingOptions& options) {
  return std::make_unique<SidCaseRun>(std::move(file), common, options);
}

}  // namespace wheeltap::apps
