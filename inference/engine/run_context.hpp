// Objects that a run uses and checkpoints do not store: problem, options, and one target per chain.
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

/// Up to this number, each model is explored and weighed separately.
inline constexpr int kFewModels = 40;
inline constexpr int kTuningSteps = 32000;  ///< per chain
inline constexpr int kDefaultDraws = 25000;
inline constexpr int kDefaultThin = 4;
/// Whether the likelihood is expensive: the data are a long record, and the engine chooses the
/// number of draws. Tuning steps and thinning are then halved. They make the draws less correlated,
/// at a cost of about a hundred times that of a formula, and the run continues anyway until the
/// draws suffice.
[[nodiscard]] inline bool is_expensive(const Problem& problem, const Options& options) {
  return problem.samples > 0 && options.draws == 0;
}
[[nodiscard]] inline int default_thin(const Problem& problem, const Options& options) {
  return is_expensive(problem, options) ? kDefaultThin / 2 : kDefaultThin;
}
[[nodiscard]] inline int tuning_steps(const Problem& problem, const Options& options) {
  return is_expensive(problem, options) ? kTuningSteps / 2 : kTuningSteps;
}
inline constexpr int kEvidenceDraws = 4000;  ///< per model, from its mixture
inline constexpr int kQuickDraws = 500;      ///< the same in a quick run

/// `problem` and `options` must outlive the context. It serves only the run state of begin() or
/// resume().
struct RunContext {
  RunContext(const Problem& of, const Options& with)
      : problem(of), options(with), monitor(with, of.space.size()), safe_points(with) {}

  const Problem& problem;
  const Options& options;
  ProgressMonitor monitor;
  SafePoints safe_points;
  Atlases atlases{};
  std::vector<std::unique_ptr<Target>> targets{};  ///< one per chain

  [[nodiscard]] const ModelSpace& space() const { return problem.space; }
  [[nodiscard]] std::size_t models() const { return static_cast<std::size_t>(space().size()); }

  /// Runs job(c, chain, target) for every chain on several threads and ranks, then stores the
  /// target's counters in its chain. A job may change only its chain, its target and its draws
  /// (RunState::posterior.chains[c]).
  template <typename Job>
  void each_chain(RunState& state, Job&& job) {
    each_chain_until(state, [&](int c, ChainState& chain, Target& target) {
      job(c, chain, target);
      return true;
    });
  }

  /// The same on every rank separately, for cheap jobs.
  template <typename Job>
  void each_chain_here(RunState& state, Job&& job) {
    for (std::size_t c = 0; c < targets.size(); ++c) {
      job(state.chains[c], *targets[c]);
      state.chains[c].target = targets[c]->memory();
    }
  }

  /// The same for a job that can stop between two iterations when leave() returns true. The job
  /// returns whether it is complete. It is called again until it is complete in every chain, or the
  /// run is stopped. The state must contain all its progress.
  template <typename Job>
  void complete_each_chain(RunState& state, Job&& job) {
    for (bool all = false; !all;) {
      all = each_chain_until(state, job);
      if (monitor.stopped()) return safe_points.stop(state);
      if (!all) safe_points.pass(state);
    }
  }
  /// Whether a job should return now.
  [[nodiscard]] bool leave() const {
    return monitor.stopped() ||
           (base::ranks() ? base::ranks()->pause_requested() : safe_points.due());
  }

 private:
  // Whether all jobs are complete.
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

/// Planned likelihood calls of the later stages, for the estimate of the remaining time.
[[nodiscard]] double planned_tuning(const RunContext& run);
[[nodiscard]] double planned_draws(const RunContext& run);
[[nodiscard]] double planned_evidence(const RunContext& run);

/// The state of a run before its first stage. Throws LikelihoodError if all models are impossible
/// (check_models).
[[nodiscard]] RunState begin(RunContext& run);

/// Whether no point drawn from the model's prior had a finite likelihood (check_models).
[[nodiscard]] bool is_impossible(const RunState& state, int model);

/// Prepares a new context to continue a run from `state`. Throws CheckpointError if the likelihood
/// at the chains' states differs in any bit: the data or the processor has changed.
void resume(RunContext& run, const RunState& state);

/// Calls of the likelihood, or of its approximation if the problem has one, by all chains and by
/// shared work.
[[nodiscard]] long likelihood_evaluations(const RunState& state);

/// The results of the run. Moves the posterior out of `state`.
[[nodiscard]] Posterior finish(const RunContext& run, RunState& state);

}  // namespace wheeltap::inference
