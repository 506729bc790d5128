// A system identification from case to draws: as many as the record's length lets one afford, and
// again with better steps where those of the integrator were too long for the noise.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// What a run was repeated with, since its steps were too long for the noise of the record.
struct StepsRefined {
  bool by_series = false;      ///< Taylor series, where there were none before
  double step_limit = 0.0;     ///< SimulatorOptions::step_limit
  bool prefer_series = false;  ///< SimulatorOptions::prefer_series
  int repeats = 1;             ///< so far, this one included
};

struct SidRunOptions {
  /// Those of the engine; warm-up and draws of 0 are chosen by what a likelihood costs.
  inference::Options engine = {};
  /// What samples; reversible_jump by default.
  std::function<inference::Posterior(const inference::Problem&, const inference::Options&)> sample =
      {};
  /// Told before anything is sampled what the case can hardly mean (sid_plausibility.hpp), if
  /// anything.
  std::function<void(const std::vector<Remark>&)> doubt = {};
  /// Told before a run is repeated.
  std::function<void(const StepsRefined&)> repeat = {};
  /// Goes on with a run that is being repeated like this.
  std::optional<StepsRefined> refined = {};
};

/// A quick look at a record that was taken at its first samples alone.
struct Look {
  int samples = 0, of = 0;
};

struct SidRun {
  std::unique_ptr<const SidProblem> problem;
  inference::Options engine;  ///< as used
  inference::Posterior posterior;
  std::optional<StepsRefined> refined;  ///< of the last repeat
  std::optional<Look> look = {};        ///< where it was quick
  std::vector<Remark> doubts = {};      ///< as told before it began
};

/// Of the scored samples, as many as a look can afford: its work is fixed, so is what one of its
/// likelihoods may cost.
[[nodiscard]] int samples_of_a_look(int samples, double seconds_a_likelihood);

/// Samples, and up to twice again with the better steps where the case does not fix them. A look is
/// taken at the first samples alone where all of them would be expensive, and not repeated. Throws
/// InvalidInput, and what `sample` does.
[[nodiscard]] SidRun run_sid(SidCase sid_case, const SidRunOptions& options);

/// How to integrate where the steps were too long for the noise (step_error), or none where they
/// were not: by series where a chain's laws let them, else by shorter steps, whose error goes with
/// their fourth power; tried on the best draws, and made better still where a motion that
/// multiplies errors asks for it.
[[nodiscard]] std::optional<dynamics::SimulatorOptions> better_integration(
    const SidProblem& problem, const inference::Posterior& posterior);

/// The engine's options where a likelihood takes so long: its own defaults where they cost less
/// than about a minute on two cores, else what that minute buys. Cores are never counted: they must
/// not change a result.
[[nodiscard]] inference::Options affordable(inference::Options engine, double seconds_a_likelihood);

}  // namespace wheeltap::identification
