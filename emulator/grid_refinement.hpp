// Refinement of full-factorial grids: levels are added only in intervals in which the interpolant
// is inaccurate.
#pragma once

#include <vector>

#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::emulator {

struct RefinementOptions {
  std::vector<double> tolerance;  ///< largest admissible error per response, in the unit of the
                                  ///< response, > 0
  const InterpolantType* interpolant = &kMultilinear;  ///< type of the interpolant on the grid
  std::vector<bool> waves = {};                        ///< see TrainingOptions::waves
  /// The admissible levels of each factor, increasing (for example element midpoints).
  /// An empty entry admits any value of the factor. An empty list admits any value of
  /// every factor.
  std::vector<std::vector<double>> candidates = {};
  Eigen::Index most_runs = 100'000;  ///< largest number of runs of the grid
  int probes = 24;  ///< number of probes per interval, at random levels of the other factors
  /// Number of random points at which the final grid must satisfy the tolerance.
  Eigen::Index check_runs = 200;
  std::uint64_t seed = 1;  ///< seed for probes and checks
  ExperimentOptions experiment = {};
};

struct RefinedGrid {
  std::vector<Factor> factors;        ///< factors with the final levels
  RowMatrix values;                   ///< runs × responses on the full-factorial grid of `factors`
  std::vector<HoldoutError> holdout;  ///< errors at the random check points of the last round
  Eigen::Index model_runs;            ///< number of all model runs, including probes and checks
  bool reached;  ///< true if all responses satisfy the tolerance at every check point
};

/// Refines a grid, starting from the factors' levels. Each round tests every interval between two
/// levels at its midpoint (in the factor's scale, or at the nearest candidate), with random levels
/// of the other factors. The midpoint becomes a level if the error of the interpolant exceeds 1/d
/// of the tolerance: to first order, the errors of the d factors add up. If no interval fails, the
/// errors at random points of the box are checked. If this check fails, the fraction 1/d of the
/// tolerance is halved, and the refinement continues. The model is run only once per point. The
/// refinement ends with `reached` = false if the grid would exceed `most_runs` or if no candidate
/// levels remain. Throws the exceptions of `run_experiment` and of the training of the interpolant,
/// and std::invalid_argument for options of inconsistent sizes, a tolerance or count that is not
/// positive, or candidates that do not increase.
[[nodiscard]] RefinedGrid refine_grid(const std::vector<Factor>& factors, Eigen::Index responses,
                                      const ModelFactory& factory,
                                      const RefinementOptions& options);

}  // namespace wheeltap::emulator
