#include "inference/reversible_jump.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include "inference/stages/explore.hpp"
#include "inference/stages/run_context.hpp"
#include "inference/stages/sample.hpp"
#include "inference/stages/tune.hpp"

namespace wheeltap::inference {

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
  RunContext run(problem, options);
  RunState state = begin(run);
  explore(run, state);
  state.posterior.warmup_evaluations = likelihood_evaluations(state);
  if (!run.monitor.stopped()) tune(run, state);
  if (!run.monitor.stopped()) sample(run, state);
  Posterior posterior = finish(run, state);
  posterior.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return posterior;
}

}  // namespace wheeltap::inference
