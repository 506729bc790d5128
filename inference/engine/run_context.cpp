#include "inference/engine/run_context.hpp"

#include <chrono>
#include <utility>

namespace wheeltap::inference {

double planned_tuning(const RunContext& run) {
  const Options& o = run.options;
  return static_cast<double>(o.warmup > 0 ? o.warmup / 2 : tuning_steps(run.problem, run.options)) *
         o.chains;
}

double planned_draws(const RunContext& run) {
  const Options& o = run.options;
  const double draws = first_draws(run.problem, o);
  return draws * (o.thin > 0 ? o.thin : default_thin(run.problem, run.options)) * o.chains;
}

double planned_evidence(const RunContext& run) {
  return run.options.prior_only || !run.options.evidences || run.space().size() > kFewModels
             ? 0.0
             : static_cast<double>(run.space().size()) *
                   (run.options.quick ? kQuickDraws : kEvidenceDraws);
}

RunState begin(RunContext& run) {
  RunState state;
  {
    Target target(run.problem, run.options.prior_only);
    // This check can take long for a slow likelihood; report progress meanwhile. With several
    // ranks, each rank makes the whole check, and no rank may stop alone.
    const auto began = std::chrono::steady_clock::now();
    double before = 0.0;
    run.monitor.begin("starting", 1.0);
    const auto goes_on = [&](double tried) {
      constexpr std::chrono::seconds kUnsaid{1};
      if (base::ranks() || std::chrono::steady_clock::now() - began < kUnsaid) return true;
      run.monitor.evaluated(1);
      return run.monitor.advance(tried - std::exchange(before, tried));
    };
    state.posterior.impossible_models = check_models(target, run.options.seed, goes_on);
    state.shared_evaluations += target.evaluations();
  }
  run.atlases = make_atlases(run.problem, run.options, state.shared_evaluations);
  const auto chains = static_cast<std::size_t>(run.options.chains);
  state.chains.resize(chains);
  run.targets.resize(chains);
  base::parallel_for(run.options.chains, run.options.threads, [&](int c) {
    const auto at = static_cast<std::size_t>(c);
    run.targets[at] = std::make_unique<Target>(run.problem, run.options.prior_only);
    state.chains[at].target = run.targets[at]->memory();
    state.chains[at].by_rung.assign(1, PilotSamples(run.space()));
  });
  state.explorations.resize(run.models());
  state.posterior.space = std::make_shared<const ModelSpace>(run.space());
  state.posterior.chains.resize(chains);
  state.posterior.thin =
      run.options.thin > 0 ? run.options.thin : default_thin(run.problem, run.options);
  state.posterior.quick = run.options.quick;
  state.posterior.dimension = run.space().max_dimension();
  return state;
}

void resume(RunContext& run, const RunState& state) {
  long counted_before = 0;
  run.atlases = make_atlases(run.problem, run.options, counted_before);
  run.targets.clear();
  for (const ChainState& chain : state.chains) {
    run.targets.push_back(std::make_unique<Target>(run.problem, run.options.prior_only));
    run.targets.back()->set_memory(chain.target);
  }
  Target fresh(run.problem, run.options.prior_only);
  const auto check = [&](const State& was) {
    if (!was.evaluated) return;
    State now;
    now.model = was.model;
    now.z = was.z;
    fresh.evaluate(now);
    if (now.log_likelihood == was.log_likelihood && now.x == was.x) return;
    throw CheckpointError(
        "the likelihood differs from that of the saved run: a file that the case refers to has "
        "changed, or the processor has a different vector instruction set");
  };
  for (const ChainState& chain : state.chains) {
    check(chain.state);
    if (chain.ladder && !chain.ladder->states.empty()) check(chain.ladder->states.back());
  }
}

bool is_impossible(const RunState& state, int model) {
  return std::ranges::find(state.posterior.impossible_models, model) !=
         state.posterior.impossible_models.end();
}

long likelihood_evaluations(const RunState& state) {
  long sum = state.shared_evaluations;
  for (const ChainState& chain : state.chains) sum += chain.target.evaluations;
  return sum;
}

Posterior finish(const RunContext& run, RunState& state) {
  Posterior& posterior = state.posterior;
  posterior.likelihood_evaluations = likelihood_evaluations(state);
  for (const ChainState& chain : state.chains) {
    posterior.full_evaluations += chain.target.full_evaluations;
    posterior.impossible += chain.target.proper.impossible + chain.target.stand_in.impossible;
  }
  Calls& calls = posterior.calls;
  calls.sample = posterior.likelihood_evaluations - calls.explore - calls.tune - calls.evidence;
  posterior.stopped_early = run.monitor.stopped();
  return std::move(posterior);
}

}  // namespace wheeltap::inference
