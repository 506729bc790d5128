// What a run works with and does not carry: the problem, the options, and one target a chain.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/parallel.hpp"
#include "inference/chains/pilot.hpp"
#include "inference/engine/checkpoint.hpp"
#include "inference/engine/run_state.hpp"
#include "inference/engine/safe_points.hpp"
#include "inference/model/target.hpp"
#include "inference/options.hpp"
#include "inference/progress_monitor.hpp"

namespace wheeltap::inference {

inline constexpr int kFewModels = 40;       ///< so many are explored and weighed each by itself
inline constexpr int kTuningSteps = 32000;  ///< a chain
inline constexpr int kDefaultDraws = 25000;
inline constexpr int kDefaultThin = 4;
/// Steps of tuning and iterations a draw are half as many where the data are a long record and the
/// number of draws is the engine's to choose: what they buy, draws closer to independent ones,
/// costs a hundred times what a formula's do, and such a run goes on drawing wherever they are too
/// few.
[[nodiscard]] inline bool is_dear(const Problem& problem, const Options& options) {
  return problem.samples > 0 && options.draws == 0;
}
[[nodiscard]] inline int default_thin(const Problem& problem, const Options& options) {
  return is_dear(problem, options) ? kDefaultThin / 2 : kDefaultThin;
}
[[nodiscard]] inline int tuning_steps(const Problem& problem, const Options& options) {
  return is_dear(problem, options) ? kTuningSteps / 2 : kTuningSteps;
}
inline constexpr int kEvidenceDraws = 4000;  ///< of each model's mixture
inline constexpr int kLookDraws = 500;       ///< the same, for a quick look

/// `problem` and `options` must outlive it. It serves the run state of begin() or resume() only.
struct RunContext {
  RunContext(const Problem& of, const Options& with)
      : problem(of), options(with), monitor(with, of.space.size()), safe_points(with) {}

  const Problem& problem;
  const Options& options;
  ProgressMonitor monitor;
  SafePoints safe_points;
  Atlases atlases{};
  std::vector<std::unique_ptr<Target>> targets{};  ///< one a chain

  [[nodiscard]] const ModelSpace& space() const { return problem.space; }
  [[nodiscard]] std::size_t models() const { return static_cast<std::size_t>(space().size()); }

  /// job(c, chain, target) for every chain, on a few threads and ranks; then each chain knows what
  /// its target has counted. A job may change its chain, its target and its draws
  /// (RunState::posterior.chains[c]), and nothing else.
  template <typename Job>
  void each_chain(RunState& state, Job&& job) {
    each_chain_until(state, [&](int c, ChainState& chain, Target& target) {
      job(c, chain, target);
      return true;
    });
  }

  /// The same by every rank for itself, where it is no work.
  template <typename Job>
  void each_chain_here(RunState& state, Job&& job) {
    for (std::size_t c = 0; c < targets.size(); ++c) {
      job(state.chains[c], *targets[c]);
      state.chains[c].target = targets[c]->memory();
    }
  }

  /// The same of a job that returns whether it has come to its end, and leaves its work between two
  /// iterations when it is told to (leave): it is called again until it has, in every chain, or the
  /// run is stopped. What it has done so far must stand in the state.
  template <typename Job>
  void bring_each_chain_to_its_end(RunState& state, Job&& job) {
    for (bool all = false; !all;) {
      all = each_chain_until(state, job);
      if (monitor.stopped()) return safe_points.stop(state);
      if (!all) safe_points.pass(state);
    }
  }
  /// Asked within such a job.
  [[nodiscard]] bool leave() const {
    return monitor.stopped() ||
           (base::ranks() ? base::ranks()->told_to_pause() : safe_points.due());
  }

 private:
  // Whether all jobs say that they have come to their end.
  template <typename Job>
  bool each_chain_until(RunState& state, Job&& job) {
    std::vector<char> ended(targets.size(), 0);
    base::Carriage carriage{
        .pack =
            [&](int c) {
              const auto at = static_cast<std::size_t>(c);
              return ended[at] + packed_state(state.chains[at], state.posterior.chains[at]);
            },
        .unpack =
            [&](int c, std::string_view bytes) {
              const auto at = static_cast<std::size_t>(c);
              ended[at] = bytes.front();
              unpack(bytes.substr(1), state.chains[at], state.posterior.chains[at]);
              targets[at]->set_memory(state.chains[at].target);
            },
        .pause = [&] { return safe_points.due(); }};
    base::parallel_for(
        options.chains, options.threads,
        [&](int c) {
          const auto at = static_cast<std::size_t>(c);
          ended[at] = job(c, state.chains[at], *targets[at]) ? 1 : 0;
          state.chains[at].target = targets[at]->memory();
        },
        carriage);
    return std::ranges::all_of(ended, [](char e) { return e == 1; });
  }
};

/// Likelihood calls that the stages to come will take, as far as that can be planned: what a
/// caller is told of the time left.
[[nodiscard]] double planned_tuning(const RunContext& run);
[[nodiscard]] double planned_draws(const RunContext& run);
[[nodiscard]] double planned_evidence(const RunContext& run);

/// A run before its first stage. Throws LikelihoodError where a model is impossible (check_models).
[[nodiscard]] RunState begin(RunContext& run);

/// Makes a new context ready to go on with a run that another one has brought so far. Throws
/// CheckpointError where the likelihood of where the chains are is not what it was to the last bit:
/// the data or the processor are others.
void resume(RunContext& run, const RunState& state);

/// Of the likelihood, or of its stand-in, by all chains and what serves all of them.
[[nodiscard]] long likelihood_evaluations(const RunState& state);

/// What the run amounts to. The state's own posterior is handed over.
[[nodiscard]] Posterior finish(const RunContext& run, RunState& state);

}  // namespace wheeltap::inference
