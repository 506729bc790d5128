// Memory, disk space and run time of a run, estimated before it starts.
#pragma once

#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Estimated cost of a run. If the run time of a likelihood evaluation was measured, the estimate
/// is correct within a factor of three in nine of ten runs (docs/scale.md). Without this
/// measurement, the estimate is correct within a factor of ten.
struct RunCost {
  double bytes = 0.0;  ///< peak memory
  double disk = 0.0;   ///< largest size of the results folder [bytes]
  /// Number of likelihood evaluations; for a table, number of FE solutions
  double likelihoods = 0.0;
  /// Run time of the likelihood evaluations on the requested threads [s]
  double seconds = 0.0;
  double preparation = 0.0;           ///< run time before the first likelihood evaluation [s]
  double seconds_a_likelihood = 0.0;  ///< run time of one likelihood evaluation [s]; 0: unknown
};

/// Sizes of a problem, known before its model space is built.
struct ProblemSize {
  double models = 1.0;
  double dimensions = 0.0;   ///< sum of the dimensions of all models
  double largest = 0.0;      ///< largest dimension of a model
  double predictions = 0.0;  ///< values stored per draw besides the parameters
  double explored = 0.0;     ///< likelihood evaluations per dimension before the first draw
  double seconds_a_likelihood = 0.0;
};

/// Estimates the cost of a run that converges in its first round of draws. If the draws take more
/// than `most_in_memory` bytes, they are stored on disk (DrawMemory). Set `most_in_memory` to
/// infinity if there is no folder for draws.
[[nodiscard]] RunCost cost_of_sampling(const ProblemSize& size, const Options& options,
                                       double most_in_memory);

/// Sets `cost.likelihoods` and `cost.seconds` from the engine's plan and the run time of a
/// likelihood evaluation. The function takes about `seconds` to measure this run time.
/// `cost.preparation` stays unchanged.
void measure(RunCost& cost, const Problem& problem, const Options& options, double seconds);

}  // namespace wheeltap::inference
