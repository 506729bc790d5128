// A complete system identification. The run adapts the number of draws to the length of the record,
// and repeats the run with shorter steps if the integration error was too large.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "identification/findings/remarks.hpp"
#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// Integration settings of a repeated run.
struct StepsRefined {
  bool by_series = false;      ///< Taylor series replace the previous integrator
  double step_limit = 0.0;     ///< SimulatorOptions::step_limit
  bool prefer_series = false;  ///< SimulatorOptions::prefer_series
  int repeats = 1;             ///< number of repetitions so far, including this one
};

struct SidRunOptions {
  /// Options of the engine. If warm-up and draws are 0, they are chosen by the run time of a
  /// likelihood.
  inference::Options engine = {};
  /// Sampling function; default: reversible_jump.
  std::function<inference::Posterior(const inference::Problem&, const inference::Options&)> sample =
      {};
  /// Callback before sampling, with remarks on implausible input (sid_plausibility.hpp), if any.
  std::function<void(const std::vector<Remark>&)> doubt = {};
  /// Callback before a run is repeated.
  std::function<void(const StepsRefined&)> repeat = {};
  /// Integration settings of a resumed run that was stopped during a repetition.
  std::optional<StepsRefined> refined = {};
};

/// A quick run that used only the first samples of a record.
struct Look {
  int samples = 0, of = 0;
};

struct SidRun {
  std::unique_ptr<const SidProblem> problem;
  inference::Options engine;  ///< engine options that the run used
  inference::Posterior posterior;
  std::optional<StepsRefined> refined;  ///< settings of the last repeat
  /// The used part of the record, for a quick run on a part of the record
  std::optional<Look> look = {};
  std::vector<Remark> doubts = {};  ///< remarks passed to `doubt`
};

/// Number of scored samples for a quick run. The number limits the time per likelihood and
/// therefore the total work.
[[nodiscard]] int samples_of_a_look(int samples, double seconds_a_likelihood);

/// Samples the posterior. The run is repeated up to twice with smaller time steps, unless the case
/// fixes the time steps. A quick run uses only the first samples if the likelihood of all samples
/// would be expensive, and is not repeated. Throws InvalidInput, and the exceptions of `sample`.
[[nodiscard]] SidRun run_sid(SidCase sid_case, const SidRunOptions& options);

/// Returns better integrator settings if the step error was too large compared with the noise
/// (step_error), otherwise std::nullopt. The new settings use Taylor series if the force laws of
/// the chain allow it, otherwise shorter steps. The error is proportional to the fourth power of
/// the step. The settings are tested on the best draws. For a chaotic motion, they are refined
/// again if necessary.
[[nodiscard]] std::optional<dynamics::SimulatorOptions> better_integration(
    const SidProblem& problem, const inference::Posterior& posterior);

/// The engine's options for a given run time per likelihood: the defaults if the run takes less
/// than about a minute on two cores. Otherwise, the number of draws is the number that two cores
/// can make in a minute. The actual number of cores is not used, because results must not depend on
/// it.
[[nodiscard]] inference::Options affordable(inference::Options engine, double seconds_a_likelihood);

}  // namespace wheeltap::identification
