// What a run works with and does not carry: the problem, the options, and one target a chain.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "base/parallel.hpp"
#include "inference/options.hpp"
#include "inference/pilot.hpp"
#include "inference/progress_monitor.hpp"
#include "inference/stages/run_state.hpp"
#include "inference/stages/safe_points.hpp"
#include "inference/target.hpp"

namespace wheeltap::inference {

inline constexpr int kFewModels = 40;       ///< so many are explored and weighed each by itself
inline constexpr int kTuningSteps = 32000;  ///< a chain
inline constexpr int kDefaultDraws = 25000;
inline constexpr int kDefaultThin = 4;
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

  /// job(c, chain, target) for every chain, on a few threads; then each chain knows what its target
  /// has counted.
  template <typename Job>
  void each_chain(RunState& state, Job&& job) {
    base::parallel_for(options.chains, options.threads, [&](int c) {
      ChainState& chain = state.chains[static_cast<std::size_t>(c)];
      Target& target = *targets[static_cast<std::size_t>(c)];
      job(c, chain, target);
      chain.target = target.memory();
    });
  }

  /// The same of a job that returns whether it has come to its end, and leaves its work between two
  /// iterations when it is told to (leave): it is called again until it has, in every chain, or the
  /// run is stopped. What it has done so far must stand in the state.
  template <typename Job>
  void bring_each_chain_to_its_end(RunState& state, Job&& job) {
    for (std::atomic<bool> all = false; !all;) {
      all = true;
      each_chain(state, [&](int c, ChainState& chain, Target& target) {
        if (!job(c, chain, target)) all = false;
      });
      if (monitor.stopped()) return safe_points.stop(state);
      if (!all) safe_points.pass(state);
    }
  }
  [[nodiscard]] bool leave() const { return monitor.stopped() || safe_points.due(); }
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
