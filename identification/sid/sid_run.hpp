// A complete system identification. The number of draws depends on the length of the record. If the
// integration error was too large, the run is repeated with shorter steps.
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
  /// Options of the engine. If the numbers of warm-up iterations and draws are 0, the run time of a
  /// likelihood evaluation determines them.
  inference::Options engine = {};
  /// Function that samples the posterior; default: reversible_jump.
  std::function<inference::Posterior(const inference::Problem&, const inference::Options&)> sample =
      {};
  /// Callback before sampling, with remarks on implausible input (sid_plausibility.hpp), if any.
  std::function<void(const std::vector<Remark>&)> doubt = {};
  /// Callback before a run is repeated.
  std::function<void(const StepsRefined&)> repeat = {};
  /// Integration settings for resuming a run that was stopped during a repetition.
  std::optional<StepsRefined> refined = {};
};

/// A quick run that used only the first samples of a record.
struct Look {
  int samples = 0, of = 0;
};

struct SidRun {
  std::unique_ptr<const SidProblem> problem;
  inference::Options engine;  ///< options of the sampler that were used
  inference::Posterior posterior;
  std::optional<StepsRefined> refined;  ///< settings of the last repeat
  /// Samples that a quick run used, if it did not use the whole record
  std::optional<Look> look = {};
  std::vector<Remark> doubts = {};  ///< remarks passed to `doubt`
};

/// Number of scored samples that a quick run uses. With fewer samples, each likelihood evaluation,
/// and therefore the run, takes less time.
[[nodiscard]] int samples_of_a_look(int samples, double seconds_a_likelihood);

/// Samples the posterior. The run is repeated up to twice with smaller time steps, unless the case
/// fixes the time steps. A quick run is never repeated; it uses only the first samples if the
/// likelihood of all samples is expensive. Throws InvalidInput, and the exceptions of `sample`.
[[nodiscard]] SidRun run_sid(SidCase sid_case, const SidRunOptions& options);

/// Returns better integrator settings if the step error is too large compared with the noise
/// (step_error), otherwise std::nullopt. The new settings use Taylor series if the force laws of
/// the chain allow this. For all other force laws, the steps are shorter, because the error is
/// proportional to the fourth power of the step. The function tests the settings on the best draws.
/// If the error is still too large, for example for chaotic motion, the settings are refined again.
[[nodiscard]] std::optional<dynamics::SimulatorOptions> better_integration(
    const SidProblem& problem, const inference::Posterior& posterior);

/// Returns the sampler's options for a given run time per likelihood evaluation. If a run with the
/// defaults takes less than about a minute on two cores, the function returns the defaults. For
/// longer runs, the function sets the number of draws to the number that two cores compute in one
/// minute. The actual number of cores has no effect, because results must not depend on it.
[[nodiscard]] inference::Options affordable(inference::Options engine, double seconds_a_likelihood);

}  // namespace wheeltap::identification
