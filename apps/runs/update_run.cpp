#include <cmath>

#include "apps/cases/structures/structure_case.hpp"
#include "apps/cases/update_case.hpp"
#include "apps/remote/outside_model.hpp"
#include "apps/remote/served_case.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/update_posterior_file.hpp"
#include "apps/results/update_summary.hpp"
#include "apps/results/update_terminal.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"
#include "apps/words.hpp"
#include "base/parallel.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// Converts errors of the library to errors of the case.
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

/// Reports the emulator of an external model and its error.
void tell_of_outside(const UpdateCaseFile& parsed, const UpdateProblem& problem, RunWatch& watch) {
  const auto& emulator = problem.program()->emulator;
  watch.note("predictions by " + in_words(*parsed.outside) +
             (emulator ? ", replaced by an emulator: " + std::to_string(emulator->runs()) +
                             " training runs of the model, and " +
                             std::to_string(emulator->fresh_runs()) +
                             " further runs that measure its error"
                       : std::string()));
  if (!emulator) return;
  const auto& holdout = emulator->error().holdout;
  const Eigen::MatrixXd noise = problem.modes().data().covariance;
  for (std::size_t m = 0; m < holdout.size(); ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    const std::string mode = "mode " + std::to_string(m + 1);
    if (holdout[m].cannot_be_predicted())
      watch.warn("the emulator cannot predict " + mode + " (Q² " + fixed(holdout[m].q2, 2) +
                 "): use more runs or narrower priors");
    else if (i < noise.rows() && holdout[m].rmse > std::sqrt(noise(i, i)))
      watch.warn("the RMS emulator error of " + mode + ", " + significant(holdout[m].rmse, 2) +
                 " Hz, is above the noise sd, " + significant(std::sqrt(noise(i, i)), 2) +
                 " Hz: use more runs");
  }
}

/// Warns of posteriors that pile up at a bound of the emulator's training domain and may extend
/// beyond.
void warn_of_the_box(const UpdateProblem& problem, const inference::Posterior& posterior,
                     RunWatch& watch) {
  if (!problem.program()->emulator) return;
  constexpr double kNear = 3.5, kShare = 0.01;  // bound (standard normal), fraction of draws
  const auto& space = problem.problem.space;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  for (int p = 0; p < problem.structural; ++p) {
    const inference::Prior& prior = space.prior(0, p);
    if (std::isfinite(prior.lower()) && std::isfinite(prior.upper())) continue;
    double near = 0.0, all = 0.0;
    for (const auto& chain : posterior.chains)
      for (std::size_t i = 0; i < chain.size(); ++i, ++all)
        near += std::abs(prior.to_standard_normal(
                    chain.theta[i * width + static_cast<std::size_t>(p)])) > kNear;
    if (near > kShare * all)
      watch.warn(space.parameter_name(0, p) +
                 " piles up at a bound of the training domain, four standard deviations from the "
                 "median of the prior: widen "
                 "the prior");
  }
}

/// Reports the reduced basis or the external predictor before sampling.
void tell_of_preparation(const UpdateCaseFile& parsed, const UpdateProblem& problem,
                         RunWatch& watch) {
  const auto basis = problem.basis() != nullptr ? problem.basis()->training()
                                                : fem::ParametricModes::Training{.complete = true};
  if (!basis.complete)
    watch.note("reduced basis: " + std::to_string(basis.basis) + " modes replace " +
               std::to_string(problem.basis()->structure().nominal().size()) +
               " degrees of freedom, " + significant(1e3 * problem.seconds_a_likelihood, 2) +
               " ms per solution");
  if (basis.beyond > 0)
    watch.warn(std::to_string(basis.beyond) + " of " + std::to_string(basis.points) +
               " draws of the prior exceed the error tolerance of the reduced basis and need full "
               "solutions: this may take a long time");
  if (parsed.outside) return tell_of_outside(parsed, problem, watch);
  for (const Remark& doubt : implausible(problem.update_case)) watch.warn(sentence(doubt, {}));
}

/// An update run. Call estimate() again after the training of the basis, which measures the time of
/// a likelihood evaluation.
class UpdateRun final : public CaseRun {
 public:
  UpdateRun(CaseFile file, const CommonOptions& common, const SamplingOptions& options)
      : CaseRun(common, options),
        parsed_(std::make_shared<const UpdateCaseFile>(parse_update_case(std::move(file)))) {}

  [[nodiscard]] const CaseFile& file() const override { return parsed_->file; }

  std::optional<RunCost> estimate() override {
    if (problem_) {
      RunCost cost =
          cost_of(problem_->problem.space.max_dimension(), problem_->seconds_a_likelihood);
      cost.bytes += bytes_held();
      if (!parsed_->outside)
        measure(cost, problem_->problem, engine_options(common(), options()),
                probe_seconds(common()));
      require_affordable(file(), Pointer(), cost, common());
      return cost;
    }
    if (!parsed_->outside) {  // training by solutions of the structure
      const auto n = static_cast<double>(discretise(parsed_->update.structure->nominal).size());
      require_affordable(file(), Pointer("/structure"),
                         {.bytes = 8.0 * n * 800.0, .seconds = 60.0 * 1e-5 * n}, common());
    }
    if (parsed_->outside && !common().dry_run && base::ranks() != nullptr)
      throw Failure(Exit::usage,
                    "an external predictor runs in one process: start it without mpirun");
    return {};
  }

  void dry_run(const std::optional<RunCost>& /*cost*/, RunWatch& watch) override {
    if (!parsed_->outside) {
      require_same_on_all_ranks("case", identity_of(file()));
      prepare(watch);
      return CaseRun::dry_run(estimate(), watch);
    }
    if (const auto& front = parsed_->outside->emulator) {
      const auto d = static_cast<int>(parsed_->outside->order.size());
      common().dry_run("emulator", {.likelihoods = static_cast<double>(front->runs_for(d) +
                                                                       front->holdout_for(d))});
    }
    const ModalData& data = parsed_->update.data;
    auto dimension = static_cast<int>(parsed_->update.structure->parameters.size());
    for (const auto& prior : {data.cov_prior, data.discrepancy.prior}) dimension += prior ? 1 : 0;
    CaseRun::dry_run(cost_of(dimension, 0.0), watch);
  }

  void prepare(RunWatch& watch) override {
    if (parsed_->outside && !common().output.empty())  // folder for the journal of results
      on_first_rank([&] { claim_output_folder(common().output); });
    UpdateProblemOptions how = {.threads = base::thread_count(common().threads)};
    const char* stage = "reduced basis";
    if (parsed_->outside) {
      const ModalData& data = parsed_->update.data;
      how.outside = open_outside(file(), *parsed_->outside, data.modes() + data.predict, common());
      how.emulator = parsed_->outside->emulator;
      stage = "emulator";
    }
    how.progress = [&](double done) { watch.show(stage, done, ""); };
    problem_ = complaining(*parsed_, [&] { return make_update_problem(parsed_->update, how); });
    watch.clear();
  }

  std::optional<FinishedRun> sample(RunWatch& watch) override;

  std::vector<ServedModel> served() override { return apps::served(problem_); }

 private:
  [[nodiscard]] RunCost cost_of(double dimension, double seconds_a_likelihood) const {
    return cost_of_sampling({.dimensions = dimension,
                             .largest = dimension,
                             .predictions = static_cast<double>(parsed_->update.data.modes()),
                             .explored = 6'000.0,
                             .seconds_a_likelihood = seconds_a_likelihood},
                            engine_options(common(), options()), draws_in_memory(common()));
  }

  std::shared_ptr<const UpdateCaseFile> parsed_;
  std::shared_ptr<const UpdateProblem> problem_;
};

std::optional<FinishedRun> UpdateRun::sample(RunWatch& watch) {
  tell_of_preparation(*parsed_, *problem_, watch);
  const auto posterior = std::make_shared<const inference::Posterior>(
      watch.sample(problem_->problem, engine_options(common(), options())));
  if (parsed_->outside) warn_of_the_box(*problem_, *posterior, watch);
  const auto evidence = compute_evidence(problem_->problem, evidence_methods(options().evidence),
                                         seed(), common().threads, watch);
  if (!base::is_first_rank()) return {};
  const auto findings = std::make_shared<const UpdateFindings>(
      update_findings(*problem_, *posterior, evidence, seed()));
  Report summary = update_summary(*parsed_, *problem_, *findings,
                                  {.seed = seed(), .command_line = common().command_line});
  summary["wheeltap"]["options"] = options_report(options());
  if (parsed_->outside)
    summary["predictor"] = outside_report(*parsed_->outside, *problem_->program()->model,
                                          problem_->program()->emulator.get());
  const std::string run = run_id(summary["wheeltap"], *posterior);
  return FinishedRun{.summary = std::move(summary),
                     .run = run,
                     .posterior = posterior,
                     .print = [parsed = parsed_, findings](
                                  std::ostream& out,
                                  bool colour) { print_update(out, *parsed, *findings, colour); },
                     .draws =
                         [parsed = parsed_, problem = problem_, posterior, run,
                          seed = seed()](const io::NetcdfWriter& to) {
                           write_update_posterior(to, run, *parsed, *problem, *posterior, seed);
                         },
                     .columns = [posterior] { return parameter_columns(*posterior); }};
}

}  // namespace

std::unique_ptr<CaseRun> make_update_run(CaseFile file, const CommonOptions& common,
                                         const SamplingOptions& options) {
  return std::make_unique<UpdateRun>(std::move(file), common, options);
}

}  // namespace wheeltap::apps
