// Planned likelihood evaluations of a run, known before it begins.
#pragma once

#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Number of likelihood evaluations of all chains in each stage. A run that has not converged after
/// its planned draws continues and needs more likelihood evaluations.
struct RunPlan {
  double explore = 0.0;  ///< evaluations by mode search, SMC or tempering, and importance sampling
  double tune = 0.0;     ///< evaluations by the tuning, including the burn-in before the draws
  double sample = 0.0;
  double evidence = 0.0;
  /// Likelihood evaluations of the exploration, converted to equivalent evaluations on the whole
  /// record. If the data are a record, most evaluations of the exploration use only its first
  /// samples. Without a record, this number equals `explore`.
  double explore_on_all_data = 0.0;

  [[nodiscard]] double calls() const { return explore + tune + sample + evidence; }
};

/// The options of a quick run (Options::quick): about 16 local optimisations per model, a thousand
/// importance-sampling draws from the normal approximations at the posterior modes, and 300
/// posterior draws per chain.
[[nodiscard]] Options quick_options(Options options);

[[nodiscard]] RunPlan plan_of(const Problem& problem, const Options& options);

/// Planned likelihood evaluations of the mode searches after tempering over sets of components, for
/// the progress monitor.
[[nodiscard]] double planned_searches(const Problem& problem, const Options& options);

}  // namespace wheeltap::inference
