// Memory, disk and run time of the engine, estimated before it runs.
#pragma once

#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// An estimate: correct within a factor of three in nine of ten runs if likelihoods were measured
/// (docs/scale.md), otherwise within a factor of ten.
struct RunCost {
  double bytes = 0.0;                 ///< largest memory in use at one time
  double disk = 0.0;                  ///< largest size of the folder of the results, in bytes
  double likelihoods = 0.0;           ///< evaluations, or FE runs of a table
  double seconds = 0.0;               ///< their time on the requested threads
  double preparation = 0.0;           ///< seconds before the first likelihood
  double seconds_a_likelihood = 0.0;  ///< 0: unknown
};

/// Sizes of a problem, known before its model space is built.
struct ProblemSize {
  double models = 1.0;
  double dimensions = 0.0;   ///< sum over all models
  double largest = 0.0;      ///< dimension of a model
  double predictions = 0.0;  ///< numbers that a draw keeps besides its parameters
  double explored = 0.0;     ///< likelihoods per dimension before the first draw
  double seconds_a_likelihood = 0.0;
};

/// Estimates the cost of a run that converges in its first round of draws. Draws of more than
/// `most_in_memory` bytes are kept on the disk (DrawMemory); it is infinite if there is no folder
/// for them.
[[nodiscard]] RunCost cost_of_sampling(const ProblemSize& size, const Options& options,
                                       double most_in_memory);

/// Sets likelihoods and seconds by the engine's plan and by the time of a likelihood, which it
/// measures for about `seconds`. Leaves `cost.preparation` unchanged.
void measure(RunCost& cost, const Problem& problem, const Options& options, double seconds);

}  // namespace wheeltap::inference
