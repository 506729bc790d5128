#include "inference/engine/reversible_jump.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number.hpp"
#include "inference/engine/checkpoint.hpp"
#include "inference/engine/explore.hpp"
#include "inference/engine/run_context.hpp"
#include "inference/engine/run_plan.hpp"
#include "inference/engine/salvage.hpp"
#include "inference/engine/sample.hpp"
#include "inference/engine/tune.hpp"

namespace wheeltap::inference {

namespace {

// Inserts the draws that were saved separately before the draws of the checkpoint.
void prepend_saved_draws(const Options::Checkpoints& from, const std::filesystem::path& folder,
                         RunState& state) {
  const Position& at = state.at;
  if (at.part_chains.empty()) return;
  if (!from.saved_draws)
    throw CheckpointError(
        "its draws are in separate parts, and Options::Checkpoints::saved_draws is not set");
  std::vector<Chain> chains(state.posterior.chains.size());
  for (Chain& chain : chains) chain.keep_in(folder);
  long number = at.first_part;
  for (const int c : at.part_chains)
    chains[static_cast<std::size_t>(c)].append(
        draws_in(from.saved_draws(number++), static_cast<std::size_t>(from.part)));
  for (std::size_t c = 0; c < chains.size(); ++c) {
    chains[c].append(state.posterior.chains[c]);
    if (chains[c].theta.size() !=
        chains[c].size() * static_cast<std::size_t>(state.posterior.dimension))
      throw CheckpointError("a part of its draws belongs to a problem with different parameters");
    state.posterior.chains[c] = std::move(chains[c]);
  }
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
  for (const NamedMove& move : problem.moves) {
    if (!(move.most >= 1.0 && std::isfinite(move.most))) {
      throw std::invalid_argument("move '" + move.name + "': most = " + base::number(move.most) +
                                  " must be finite and at least 1");
    }
    if (!move.make) throw std::invalid_argument("move '" + move.name + "': `make` is not set");
  }
  const Options chosen = options.quick ? quick_options(options) : options;
  RunContext run(problem, chosen);
  RunState state;
  if (options.checkpoints.from) {
    state = state_of(*options.checkpoints.from, problem.space, options.chains);
    prepend_saved_draws(options.checkpoints, options.draws_folder, state);
    for (const Chain& chain : state.posterior.chains)
      if (static_cast<long>(chain.size()) > state.at.goal)
        throw CheckpointError("it has more draws than the options request");
    resume(run, state);
  } else {
    state = begin(run);
    if (run.monitor.stopped()) return finish(run, state);  // like a run without steps
    run.safe_points.pass(state);
  }
  for (Chain& chain : state.posterior.chains) chain.keep_in(options.draws_folder);
  using Stage = Position::Stage;
  if (state.at.stage == Stage::explore) explore(run, state);
  if (state.at.stage == Stage::tune && !run.monitor.stopped()) tune(run, state);
  if (state.at.stage == Stage::sample && !run.monitor.stopped()) sample(run, state);
  if (run.monitor.stopped()) {
    run.safe_points.stopped();
    if (state.at.stage == Stage::explore) count_exploring(state);
    salvage(run, state);
  }
  run.safe_points.clock(state);
  return finish(run, state);
}

}  // namespace wheeltap::inference
