#include "identification/sid/sid_run.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/findings/marginal.hpp"
#include "identification/sid/sid_fit.hpp"
#include "identification/sid/sid_plausibility.hpp"
#include "identification/sid/sid_residuals.hpp"

namespace wheeltap::identification {
namespace {

/// The engine's default effort, in likelihoods (reversible_jump.cpp): sufficient for hard problems,
/// but too expensive for records whose likelihood takes milliseconds.
constexpr double kDefaultWarmup = 70'000;  ///< per chain
constexpr double kDefaultDraws = 25'000;   ///< per chain, four iterations each
constexpr double kAffordableSeconds = 60.0;
constexpr double kFewestSidDraws = 3'000;
constexpr double kFewestWarmup = 6'000;

/// Step error that repeated runs aim at, and the largest number of repeated runs.
constexpr double kWantedStepError = 0.1;
constexpr int kMostRepeats = 2;
constexpr int kMostTried = 3;        // trial integrations before a run is repeated
constexpr int kMostRefinement = 16;  // largest factor on the step limit, per trial
constexpr double kCounts = 0.05;     // models with a smaller share of the draws are ignored

/// Weighted share of the draws of each model.
std::vector<double> shares(const inference::Posterior& posterior) {
  const std::vector<double> weights = model_weights(posterior);
  std::vector<double> visits(weights.size());
  for (const auto& chain : posterior.chains) {
    for (const int m : chain.model) {
      visits[static_cast<std::size_t>(m)] += weights[static_cast<std::size_t>(m)];
    }
  }
  const double all = std::accumulate(visits.begin(), visits.end(), 0.0);
  for (double& v : visits) v /= all;
  return visits;
}

}  // namespace

inference::Options affordable(inference::Options engine, double seconds_a_likelihood) {
  // Likelihoods that each chain can evaluate on two cores, regardless of this machine.
  const double likelihoods = kAffordableSeconds * 2.0 / engine.chains / seconds_a_likelihood;
  const double thin = engine.draws == 0 ? 2.0 : 4.0;  // the engine's own thinning
  if (engine.prior_only || kDefaultWarmup + thin * kDefaultDraws <= likelihoods) return engine;
  engine.thin = 1;
  if (engine.warmup == 0) {
    engine.warmup = static_cast<int>(std::clamp(0.5 * likelihoods, kFewestWarmup, kDefaultWarmup));
  }
  if (engine.draws == 0) {
    engine.draws = static_cast<int>(std::clamp(0.5 * likelihoods, kFewestSidDraws, kDefaultDraws));
  }
  return engine;
}

namespace {

// Better integrator settings, chosen by the step errors at the best draws of the models.
std::optional<dynamics::SimulatorOptions> finer_integration(const SidProblem& problem,
                                                            const inference::Posterior& posterior) {
  const std::vector<double> share = shares(posterior);
  dynamics::SimulatorOptions better = problem.sid_case.integration;
  bool needed = false;
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    if (share[static_cast<std::size_t>(m)] < kCounts) continue;
    const double error = step_error(problem, posterior, m).value_or(0.0);
    if (error <= kLargestStepError) continue;
    needed = true;
    const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(m)];
    const dynamics::Simulator& simulator = misfit.simulator();
    const dynamics::SimulatorOptions& now = problem.sid_case.integration;
    if (dynamics::has_series(simulator.chain()) && !now.prefer_series) {
      better.prefer_series = true;
      continue;
    }
    // The number of steps changes in jumps: halve the step limit until the number is large enough.
    const auto theta = posterior_mean(problem, posterior, m);
    const double enough = simulator.substeps(theta) * std::pow(error / kWantedStepError, 0.25);
    int factor = 2;
    while (factor < kMostRefinement && simulator.refined(factor).substeps(theta) < enough)
      factor *= 2;
    better.step_limit = std::min(better.step_limit, now.step_limit / factor);
  }
  return needed ? std::optional(better) : std::nullopt;
}

}  // namespace

std::optional<dynamics::SimulatorOptions> better_integration(
    const SidProblem& problem, const inference::Posterior& posterior) {
  std::optional<dynamics::SimulatorOptions> better = finer_integration(problem, posterior);
  for (int i = 0; better && i < kMostTried; ++i) {
    SidCase finer = problem.sid_case;
    finer.integration = *better;
    const auto more = finer_integration(*make_sid_problem(std::move(finer)), posterior);
    if (!more) break;
    better = more;
  }
  return better;
}

int samples_of_a_look(int samples, double seconds_a_likelihood) {
  constexpr double kAffordable = 1.5e-4;  // seconds per likelihood, for about 20 000
  constexpr int kFewest = 200;
  const double share = std::min(1.0, kAffordable / seconds_a_likelihood);
  return std::min(samples, std::max(kFewest, static_cast<int>(share * samples)));
}

SidRun run_sid(SidCase sid_case, const SidRunOptions& options) {
  choose_residuals(sid_case, options.engine.seed, options.engine.threads);
  SidRun run{.problem = make_sid_problem(std::move(sid_case)),
             .engine = {},
             .posterior = {},
             .refined = {}};
  run.doubts = implausible(*run.problem);
  if (options.doubt && !run.doubts.empty()) options.doubt(run.doubts);
  const int all = run.problem->misfits.front().samples();
  if (const int few = samples_of_a_look(all, run.problem->seconds_a_likelihood);
      options.engine.quick && few < all)
    run.problem = make_sid_problem(shortened(run.problem->sid_case, few));
  const auto integrate_like = [&](const StepsRefined& how) {
    run.refined = how;
    SidCase finer = run.problem->sid_case;
    finer.integration.prefer_series = how.prefer_series;
    finer.integration.step_limit = how.step_limit;
    run.problem = make_sid_problem(std::move(finer));
  };
  if (options.refined) integrate_like(*options.refined);
  for (int repeats = run.refined ? run.refined->repeats : 0;; ++repeats) {
    const SidCase& now = run.problem->sid_case;
    run.engine = options.engine;
    run.engine.balance = now.balance;
    if (!run.engine.quick)
      run.engine = affordable(std::move(run.engine), run.problem->seconds_a_likelihood);
    run.posterior = options.sample ? options.sample(run.problem->problem, run.engine)
                                   : inference::reversible_jump(run.problem->problem, run.engine);
    if (run.engine.quick && run.problem->misfits.front().samples() < all) {
      run.look = {.samples = run.problem->misfits.front().samples(), .of = all};
    }
    if (now.fixed_integration || run.engine.prior_only || run.engine.quick ||
        run.posterior.stopped_early)
      break;
    const auto better = better_integration(*run.problem, run.posterior);
    if (!better || repeats == kMostRepeats) break;
    const StepsRefined how{.by_series = better->prefer_series && !now.integration.prefer_series,
                           .step_limit = better->step_limit,
                           .prefer_series = better->prefer_series,
                           .repeats = repeats + 1};
    if (options.repeat) options.repeat(how);
    integrate_like(how);
  }
  return run;
}

}  // namespace wheeltap::identification
