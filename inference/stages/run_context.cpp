#include "inference/stages/run_context.hpp"

#include <utility>

namespace wheeltap::inference {

RunState begin(RunContext& run) {
  RunState state;
  {
    Target target(run.problem, run.options.prior_only);
    check_models(target, run.options.seed);
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
  state.posterior.thin = run.options.thin > 0 ? run.options.thin : 4;
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
  posterior.stopped_early = run.monitor.stopped();
  return std::move(posterior);
}

}  // namespace wheeltap::inference
