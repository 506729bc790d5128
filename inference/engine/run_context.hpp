// The data of a run that are not stored in a checkpoint: problem, options, and one target per
// chain.
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

/// Largest number of models for which each model is explored and its evidence computed separately.
inline constexpr int kFewModels = 40;
inline constexpr int kTuningSteps = 32000;  ///< tuning steps per chain
inline constexpr int kDefaultDraws = 25000;
inline constexpr int kDefaultThin = 4;
inline constexpr int kCostlyDraws = 2500;  ///< default number of draws if an evaluation is costly
/// True if the engine chooses the number of draws and the likelihood is expensive: a long record or
/// a costly problem. The number of tuning steps and the thinning interval are then halved, because
/// each MCMC step takes about a hundred times as long as with an analytical likelihood. For a
/// costly problem, the draws are not thinned. Every run continues until it has enough draws.
[[nodiscard]] inline bool is_expensive(const Problem& problem, const Options& options) {
  return (problem.samples > 0 || problem.costly) && options.draws == 0;
}
/// The number of draws per chain after which convergence is judged for the first time.
[[nodiscard]] inline int first_draws(const Problem& problem, const Options& options) {
  if (options.draws > 0) return options.draws;
  return problem.costly ? kCostlyDraws : kDefaultDraws;
}
/// The number of SMC particles with which each of several models is explored. `brief` is the length
/// of the run divided by that of a default run.
[[nodiscard]] inline int annealing_particles(const Problem& problem, double brief, double models) {
  constexpr double kAll = 12000.0, kFewest = 400.0, kMost = 1200.0;
  if (problem.costly) return static_cast<int>(kFewest);
  return static_cast<int>(std::clamp(brief * kAll / (models + 1.0), kFewest, kMost));
}
[[nodiscard]] inline int default_thin(const Problem& problem, const Options& options) {
  if (problem.costly && options.draws == 0) return 1;
  return is_expensive(problem, options) ? kDefaultThin / 2 : kDefaultThin;
}
[[nodiscard]] inline int tuning_steps(const Problem& problem, const Options& options) {
  return is_expensive(problem, options) ? kTuningSteps / 2 : kTuningSteps;
}
inline constexpr int kEvidenceDraws = 4000;  ///< draws per model from its mixture
inline constexpr int kQuickDraws = 500;      ///< draws per model from its mixture in a quick run

/// `problem` and `options` must outlive the context. Use the context only with the run state
/// from begin() or resume().
struct RunContext {
  RunContext(const Problem& of, const Options& with)
      : problem(of), options(with), monitor(with, of.space.size()), safe_points(with) {}

  const Problem& problem;
  const Options& options;
  ProgressMonitor monitor;
  SafePoints safe_points;
  Atlases atlases{};
  std::vector<std::unique_ptr<Target>> targets{};  ///< one target per chain

  [[nodiscard]] const ModelSpace& space() const { return problem.space; }
  [[nodiscard]] std::size_t models() const { return static_cast<std::size_t>(space().size()); }

  /// Calls job(c, chain, target) for every chain on several threads and ranks, then stores the
  /// target's counters in the state of the chain. The job for chain c may change only this chain,
  /// its target and its draws (RunState::posterior.chains[c]).
  template <typename Job>
  void each_chain(RunState& state, Job&& job) {
    each_chain_until(state, [&](int c, ChainState& chain, Target& target) {
      job(c, chain, target);
      return true;
    });
  }

  /// Runs a cheap job for every chain on every rank, without communication between the ranks.
  template <typename Job>
  void each_chain_here(RunState& state, Job&& job) {
    for (std::size_t c = 0; c < targets.size(); ++c) {
      job(state.chains[c], *targets[c]);
      state.chains[c].target = targets[c]->memory();
    }
  }

  /// Runs a job that can pause between two iterations if leave() returns true. The job returns true
  /// if it is complete. The job is called repeatedly, until it is complete for every chain or the
  /// run is stopped. The run state must contain all progress of the job.
  template <typename Job>
  void complete_each_chain(RunState& state, Job&& job) {
    for (bool all = false; !all;) {
      all = each_chain_until(state, job);
      if (monitor.stopped()) return safe_points.stop(state);
      if (!all) safe_points.pass(state);
    }
  }
  /// True if a job should return now.
  [[nodiscard]] bool leave() const {
    return monitor.stopped() ||
           (base::ranks() ? base::ranks()->pause_requested() : safe_points.due());
  }

 private:
  // True if the jobs of all chains are complete.
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

/// Planned likelihood evaluations of the later stages, for the estimate of the remaining time.
[[nodiscard]] double planned_tuning(const RunContext& run);
[[nodiscard]] double planned_draws(const RunContext& run);
[[nodiscard]] double planned_evidence(const RunContext& run);

/// The state of a run before its first stage. Throws LikelihoodError if no model has a draw with
/// positive likelihood (check_models).
[[nodiscard]] RunState begin(RunContext& run);

/// True if no draw from the model's prior had a positive likelihood (check_models).
[[nodiscard]] bool is_impossible(const RunState& state, int model);

/// Prepares a new context to continue a run from `state`. Throws CheckpointError if the likelihood
/// at the chains' states differs in any bit, because the data or the processor have changed.
void resume(RunContext& run, const RunState& state);

/// Number of likelihood evaluations by all chains and outside the chains. If the problem has an
/// approximate likelihood, the evaluations of the approximation are counted.
[[nodiscard]] long likelihood_evaluations(const RunState& state);

/// The results of the run. Moves the posterior out of `state`.
[[nodiscard]] Posterior finish(const RunContext& run, RunState& state);

}  // namespace wheeltap::inference
