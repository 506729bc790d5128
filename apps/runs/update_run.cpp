#include "apps/runs/update_run.hpp"

#include <cmath>

#include "apps/cases/structures/structure_case.hpp"
#include "apps/remote/outside_model.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/update_posterior_file.hpp"
#include "apps/results/update_summary.hpp"
#include "apps/results/update_terminal.hpp"
#include "apps/runs/running.hpp"
#include "apps/words.hpp"
#include "base/parallel.hpp"
#include "identification/structural/updating/update_findings.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// What the library finds wrong, as a complaint about the case.
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

/// What stands in front of the model, before it is trusted.
void tell_of_outside(const UpdateCaseFile& parsed, const UpdateProblem& problem, RunWatch& watch) {
  const auto& emulator = problem.program()->emulator;
  watch.note("predictions by " + in_words(*parsed.outside) +
             (emulator ? ", with an emulator in front: " + std::to_string(emulator->runs()) +
                             " runs of the model, and " + std::to_string(emulator->fresh_runs()) +
                             " fresh ones that measure its error"
                       : std::string()));
  if (!emulator) return;
  const auto& holdout = emulator->error().holdout;
  const Eigen::MatrixXd noise = problem.modes().data().covariance;
  for (std::size_t m = 0; m < holdout.size(); ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    const std::string mode = "mode " + std::to_string(m + 1);
    if (holdout[m].cannot_be_predicted())
      watch.warn("the emulator cannot predict " + mode + " (Q² " + fixed(holdout[m].q2, 2) +
                 "): more runs, or narrower priors");
    else if (i < noise.rows() && holdout[m].rmse > std::sqrt(noise(i, i)))
      watch.warn("the emulator's error of " + mode + ", " + significant(holdout[m].rmse, 2) +
                 " Hz, is above the noise, " + significant(std::sqrt(noise(i, i)), 2) +
                 " Hz: more runs would tell more");
  }
}

/// A posterior that leans on the emulator's box would go on beyond it.
void warn_of_the_box(const UpdateProblem& problem, const inference::Posterior& posterior,
                     RunWatch& watch) {
  if (!problem.program()->emulator) return;
  constexpr double kNear = 3.5, kShare = 0.01;  // standard normal, of the draws
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
                 " leans on the end of the emulator's box, four standard deviations of its prior: "
                 "widen the prior");
  }
}

RunCost cost_of(int dimension, int modes, double seconds_a_likelihood, const CommonOptions& common,
                const SamplingOptions& options) {
  const double d = dimension;
  return cost_of_sampling({.models = 1.0,
                           .dimensions = d,
                           .largest = d,
                           .predictions = static_cast<double>(modes),
                           .explored = 6'000.0,
                           .seconds_a_likelihood = seconds_a_likelihood},
                          common, options);
}

}  // namespace

RunCost cost_of_outside(const UpdateCaseFile& parsed, const CommonOptions& common,
                        const SamplingOptions& options) {
  const ModalData& data = parsed.update.data;
  auto d = static_cast<int>(parsed.update.structure->parameters.size());
  for (const auto& prior : {data.cov_prior, data.discrepancy.prior}) d += prior ? 1 : 0;
  return cost_of(d, data.modes(), 0.0, common, options);
}

RunCost cost_of_update(const UpdateProblem& problem, const CommonOptions& common,
                       const SamplingOptions& options) {
  RunCost cost = cost_of(problem.problem.space.max_dimension(), problem.update_case.data.modes(),
                         problem.seconds_a_likelihood, common, options);
  cost.bytes += bytes_held();
  if (problem.program() == nullptr)
    measure(cost, problem.problem, engine_options(common, options), probe_seconds(common));
  return cost;
}

RunCost cost_of_basis(const UpdateCaseFile& parsed) {
  if (parsed.outside) return {};
  const auto n = static_cast<double>(discretise(parsed.update.structure->nominal).size());
  return {.bytes = 8.0 * n * 800.0, .seconds = 60.0 * 1e-5 * n};
}

std::shared_ptr<const UpdateProblem> prepare_update(const UpdateCaseFile& parsed,
                                                    const CommonOptions& common, RunWatch& watch) {
  UpdateProblemOptions options = {.threads = base::thread_count(common.threads)};
  const char* stage = "reduced basis";
  if (parsed.outside) {
    const ModalData& data = parsed.update.data;
    options.outside =
        open_outside(parsed.file, *parsed.outside, data.modes() + data.predict, common);
    options.emulator = parsed.outside->emulator;
    stage = "emulator";
  }
  options.progress = [&](double done) { watch.show(stage, done, ""); };
  std::shared_ptr<const UpdateProblem> problem =
      complaining(parsed, [&] { return make_update_problem(parsed.update, options); });
  watch.clear();
  return problem;
}

std::optional<FinishedRun> sample_update(std::shared_ptr<const UpdateCaseFile> parsed,
                                         std::shared_ptr<const UpdateProblem> problem,
                                         const CommonOptions& common,
                                         const SamplingOptions& options, RunWatch& watch) {
  const auto methods = evidence_methods(options.evidence);
  const std::uint64_t seed = common.seed.value_or(1);
  const auto basis = problem->basis() != nullptr ? problem->basis()->training()
                                                 : fem::ParametricModes::Training{.complete = true};
  if (!basis.complete)
    watch.note("reduced basis: " + std::to_string(basis.basis) + " modes stand for " +
               std::to_string(problem->basis()->structure().nominal().size()) +
               " degrees of freedom, " + significant(1e3 * problem->seconds_a_likelihood, 2) +
               " ms a solution");
  if (basis.beyond > 0)
    watch.warn(std::to_string(basis.beyond) + " of " + std::to_string(basis.points) +
               " draws of the prior are beyond the basis and solved in full: this may take long");
  if (parsed->outside) tell_of_outside(*parsed, *problem, watch);
  if (!parsed->outside)
    for (const Remark& doubt : implausible(problem->update_case)) watch.warn(sentence(doubt, {}));
  const auto posterior = std::make_shared<const inference::Posterior>(
      watch.sample(problem->problem, engine_options(common, options)));
  if (parsed->outside) warn_of_the_box(*problem, *posterior, watch);
  const auto evidence = compute_evidence(problem->problem, methods, seed, common.threads, watch);
  if (!base::is_first_rank()) return {};
  const auto findings =
      std::make_shared<const UpdateFindings>(update_findings(*problem, *posterior, evidence, seed));
  Report summary = update_summary(*parsed, *problem, *findings,
                                  {.seed = seed, .command_line = common.command_line});
  summary["wheeltap"]["options"] = options_report(options);
  if (parsed->outside)
    summary["predictor"] = outside_report(*parsed->outside, *problem->program()->model,
                                          problem->program()->emulator.get());
  const std::string run = run_id(summary["wheeltap"], *posterior);
  return FinishedRun{
      .summary = std::move(summary),
      .run = run,
      .posterior = posterior,
      .print = [parsed, findings](std::ostream& out,
                                  bool colour) { print_update(out, *parsed, *findings, colour); },
      .draws =
          [parsed, problem, posterior, run, seed](const io::NetcdfWriter& file) {
            write_update_posterior(file, run, *parsed, *problem, *posterior, seed);
          },
      .columns = [posterior] { return parameter_columns(*posterior); }};
}

}  // namespace wheeltap::apps
