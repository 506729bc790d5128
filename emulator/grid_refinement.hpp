// Full-factorial grids that grow levels only where the interpolant needs them.
#pragma once

#include <vector>

#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::emulator {

struct RefinementOptions {
  std::vector<double> tolerance;  ///< largest error aimed at, one per response, in its unit, > 0
  const InterpolantType* interpolant = &kMultilinear;  ///< what joins the levels, a grid's
  std::vector<bool> waves = {};  ///< of the factors, as TrainingOptions has it
  /// Per factor, the only values its levels may take, increasing (e.g. element midpoints); empty
  /// where any value will do. None given at all: any value for every factor.
  std::vector<std::vector<double>> candidates = {};
  Eigen::Index most_runs = 100'000;  ///< of the grid
  int probes = 24;  ///< places on the other factors' levels where an interval is tried
  Eigen::Index check_runs = 200;  ///< random points that the finished grid must satisfy
  std::uint64_t seed = 1;         ///< of probes and checks
  ExperimentOptions experiment = {};
};

struct RefinedGrid {
  std::vector<Factor> factors;        ///< with the levels found
  RowMatrix values;                   ///< runs × responses on their full factorial
  std::vector<HoldoutError> holdout;  ///< at the check points of the last round
  Eigen::Index model_runs;            ///< all that were made, probes and checks included
  bool reached;  ///< true where no check point misses the tolerance in any response
};

/// Starts from the factors' own levels. In each round every interval between two levels is tried at
/// its middle (in the factor's scale; or the nearest candidate), the other factors on levels drawn
/// at random, and gains that middle as a level where the interpolant misses the model by more than
/// 1/d of the tolerance: to first order the errors of the d factors add. When no interval does, the
/// grid is checked at random points of the box, and the share is halved for as long as they miss.
/// No point is run twice. Ends unreached when `most_runs` would be passed or candidates run out.
/// Throws as `run_experiment` and the interpolant's training do, and std::invalid_argument for
/// options whose sizes do not fit, a tolerance or count that is not positive, or candidates that do
/// not increase.
[[nodiscard]] RefinedGrid refine_grid(const std::vector<Factor>& factors, Eigen::Index responses,
                                      const ModelFactory& factory,
                                      const RefinementOptions& options);

}  // namespace wheeltap::emulator
