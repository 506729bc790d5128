// A complete system identification. It adapts the number of draws to the length of the record, and
// repeats the run with shorter steps if the integration error was too large.
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
  int repeats = 1;             ///< including this one
};

struct SidRunOptions {
  /// Options of the engine; warm-up and draws of 0 are chosen by the run time of a likelihood.
  inference::Options engine = {};
  /// Sampling function; default: reversible_jump.
  std::function<inference::Posterior(const inference::Problem&, const inference::Options&)> sample =
      {};
  /// Called before sampling with remarks on implausible input (sid_plausibility.hpp), if any.
  std::function<void(const std::vector<Remark>&)> doubt = {};
  /// Called before a run is repeated.
  std::function<void(const StepsRefined&)> repeat = {};
  /// Resumes a run that was being repeated with these settings.
  std::optional<StepsRefined> refined = {};
};

/// A quick run that used only the first samples of a record.
struct Look {
  int samples = 0, of = 0;
};

struct SidRun {
  std::unique_ptr<const SidProblem> problem;
  inference::Options engine;  ///< as used
  inference::Posterior posterior;
  std::optional<StepsRefined> refined;  ///< settings of the last repeat
  std::optional<Look> look = {};        ///< if it was a quick run on part of the record
  std::vector<Remark> doubts = {};      ///< as passed to `doubt`
};

/// Number of scored samples for a quick run, whose work and therefore time per likelihood are
/// bounded.
[[nodiscard]] int samples_of_a_look(int samples, double seconds_a_likelihood);

/// Samples the posterior, and repeats the run up to twice with better steps unless the case fixes
/// them. A quick run uses only the first samples if all of them would be expensive, and is not
/// repeated. Throws InvalidInput, and the exceptions of `sample`.
[[nodiscard]] SidRun run_sid(SidCase sid_case, const SidRunOptions& options);

/// Returns better integrator settings if the step error was too large compared with the noise
/// (step_error), otherwise std::nullopt. Selects series if the laws of the chain allow them,
/// otherwise shorter steps; the error is proportional to the fourth power of the step. The settings
/// are tested on the best draws, and refined again if necessary for a chaotic motion.
[[nodiscard]] std::optional<dynamics::SimulatorOptions> better_integration(
    const SidProblem& problem, const inference::Posterior& posterior);

/// The engine's options for this run time per likelihood: the defaults if they take less than about
/// a minute on two cores, otherwise the number of draws that two cores can make in a minute. The
/// actual number of cores is not used, because it must not change results.
[[nodiscard]] inference::Options affordable(inference::Options engine, double seconds_a_likelihood);

}  // namespace wheeltap::identification
