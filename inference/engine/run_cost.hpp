// Memory, disk and run time of the engine, estimated before it runs.
#pragma once

#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// An estimate, not a promise: within a factor of three of nine in ten runs where likelihoods were
/// measured (docs/scale.md), else within a factor of ten.
struct RunCost {
  double bytes = 0.0;                 ///< of memory, at the most at one time
  double disk = 0.0;                  ///< bytes in the folder of the results, likewise
  double likelihoods = 0.0;           ///< evaluations, or FE runs of a table
  double seconds = 0.0;               ///< of them, on the threads asked for
  double preparation = 0.0;           ///< of these, before the first likelihood
  double seconds_a_likelihood = 0.0;  ///< 0: not said
};

/// Sizes of a problem; its model space need not have been built for them.
struct ProblemSize {
  double models = 1.0;
  double dimensions = 0.0;   ///< of all models together
  double largest = 0.0;      ///< dimension of a model
  double predictions = 0.0;  ///< numbers that a draw keeps besides its parameters
  double explored = 0.0;     ///< likelihoods a dimension before the first draw
  double seconds_a_likelihood = 0.0;
};

/// Of a run that converges in its first round of draws. Draws that take more than `most_in_memory`
/// bytes are kept on the disk (DrawMemory); infinity where there is no folder for them.
[[nodiscard]] RunCost cost_of_sampling(const ProblemSize& size, const Options& options,
                                       double most_in_memory);

/// Takes likelihoods and seconds from the engine's plan and from the time of a likelihood, which is
/// measured for about so many seconds. `cost.preparation` stays as it is.
void measure(RunCost& cost, const Problem& problem, const Options& options, double seconds);

}  // namespace wheeltap::inference
