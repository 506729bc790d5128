// Refines full-factorial grids: adds levels only where the interpolant is inaccurate.
#pragma once

#include <vector>

#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::emulator {

struct RefinementOptions {
  std::vector<double> tolerance;  ///< largest admissible error, one per response, in its unit, > 0
  const InterpolantType* interpolant = &kMultilinear;  ///< type of interpolant on the grid
  std::vector<bool> waves = {};                        ///< one per factor, see TrainingOptions
  /// The admissible levels of each factor, increasing (e.g. element midpoints); an empty entry
  /// admits any value. An empty list admits any value of every factor.
  std::vector<std::vector<double>> candidates = {};
  Eigen::Index most_runs = 100'000;  ///< limit for the grid
  int probes = 24;  ///< points at which an interval is tested, on levels of the other factors
  /// Random points at which the final grid must satisfy the tolerance.
  Eigen::Index check_runs = 200;
  std::uint64_t seed = 1;  ///< for probes and checks
  ExperimentOptions experiment = {};
};

struct RefinedGrid {
  std::vector<Factor> factors;        ///< with the final levels
  RowMatrix values;                   ///< runs × responses on their full factorial
  std::vector<HoldoutError> holdout;  ///< at the check points of the last round
  Eigen::Index model_runs;            ///< all model runs, including probes and checks
  bool reached;  ///< every check point satisfies the tolerance in every response
};

/// Refines a grid, starting from the factors' levels. Each round tests every interval between two
/// levels at its middle (in the factor's scale, or the nearest candidate), with the other factors
/// on random levels. The middle becomes a level if the error of the interpolant exceeds 1/d of the
/// tolerance, since the errors of the d factors add to first order. If no interval fails, random
/// points of the box check the grid, and the fraction 1/d is halved as long as they fail. No point
/// is run twice. Ends with `reached` = false if the grid would exceed `most_runs` or candidates run
/// out. Throws the exceptions of `run_experiment` and of the training of the interpolant, and
/// std::invalid_argument for options whose sizes do not fit, a tolerance or count that is not
/// positive, or candidates that do not increase.
[[nodiscard]] RefinedGrid refine_grid(const std::vector<Factor>& factors, Eigen::Index responses,
                                      const ModelFactory& factory,
                                      const RefinementOptions& options);

}  // namespace wheeltap::emulator
