// Simulated annealing: a random walk that is cooled until it stays at a mode.
#pragma once

#include <cstdint>
#include <limits>

#include "inference/search/optimum.hpp"

namespace wheeltap::inference {

struct AnnealingOptions {
  std::uint64_t seed = 1;
  long evaluations = 20000;
  double start_sd = 1.0;             ///< starts at the best of 50 draws from N(0, start_sd² I)
  double initial_temperature = 0.0;  ///< 0: the spread of the objective over those draws
  double final_temperature = 1e-4;   ///< in units of the objective (of log density, so nats)
  double bound = std::numeric_limits<double>::infinity();  ///< |z_i| <= bound: beyond is refused
};

/// Maximises by Metropolis steps on exp(f / T), T falling geometrically (Kirkpatrick et al. 1983).
/// One coordinate moves at a time, its step adapted to an acceptance of 0.44 as the temperature
/// falls (Corana et al. 1987); the best point met is returned. For a log posterior, T = 1 is the
/// posterior itself, so that the schedule passes from a flattened target through it to its mode.
///
/// Throws std::invalid_argument for a dimension or an option out of range.
[[nodiscard]] Optimum maximise_by_annealing(const Objective& objective, int dimension,
                                            const AnnealingOptions& options);

}  // namespace wheeltap::inference
