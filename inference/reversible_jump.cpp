#include "inference/reversible_jump.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include "inference/stages/explore.hpp"
#include "inference/stages/run_context.hpp"
#include "inference/stages/salvage.hpp"
#include "inference/stages/sample.hpp"
#include "inference/stages/tune.hpp"

namespace wheeltap::inference {

namespace {

// The work of a look: some 16 climbs a model, a thousand draws from the normals about their modes,
// 4 x 300 draws.
Options as_a_look(Options options) {
  constexpr int kClimbs = 16, kWarmup = 600, kDraws = 300;
  if (options.searches == 0) options.searches = kClimbs;
  if (options.warmup == 0) options.warmup = kWarmup;
  if (options.draws == 0) options.draws = kDraws;
  if (options.thin == 0) options.thin = 1;
  return options;
}

}  // namespace

Posterior reversible_jump(const Problem& problem, const Options& options) {
  if (options.chains < 1) {
    throw std::invalid_argument("chains = " + std::to_string(options.chains) +
                                " must be at least 1");
  }
  for (const auto& [name, value] :
       {std::pair{"draws", options.draws}, std::pair{"warmup", options.warmup},
        std::pair{"thin", options.thin}, std::pair{"threads", options.threads}}) {
    if (value < 0) {
      throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) +
                                  " must be at least 0 (0: the engine chooses)");
    }
  }
  const auto began = std::chrono::steady_clock::now();
  const Options chosen = options.quick ? as_a_look(options) : options;
  RunContext run(problem, chosen);
  RunState state = begin(run);
  explore(run, state);
  state.posterior.calls.explore = state.posterior.warmup_evaluations =
      likelihood_evaluations(state);
  if (!run.monitor.stopped()) tune(run, state);
  if (!run.monitor.stopped()) sample(run, state);
  if (run.monitor.stopped()) salvage(run, state);
  Posterior posterior = finish(run, state);
  posterior.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return posterior;
}

}  // namespace wheeltap::inference
