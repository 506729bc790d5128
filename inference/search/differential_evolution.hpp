// Self-adaptive differential evolution (SADE): finds starting points and modes with nothing to
// tune.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "inference/search/optimum.hpp"

namespace wheeltap::inference {

struct SadeOptions {
  std::uint64_t seed = 1;
  int population = 0;  ///< 0: 10 a dimension, at least 30
  int generations = 1000;
  double start_sd = 1.0;                        ///< the first population is N(0, start_sd² I)
  std::vector<std::vector<double>> start = {};  ///< its first members, where not empty
  double bound = std::numeric_limits<double>::infinity();  ///< |z_i| <= bound, by reflection
  /// Stops when best and worst of the population differ by less than this.
  double tolerance = 1e-9;
};

/// Maximises by differential evolution whose control parameters adapt themselves (Qin & Suganthan
/// 2005, IEEE CEC 2:1785). Each trial vector comes from one of
///
///   rand/1:             v = z_a + F (z_b - z_c),
///   current-to-best/2:  v = z_i + F (z_best - z_i) + F (z_a - z_b),
///
/// crossed binomially with z_i and kept if no worse. F ~ N(0.5, 0.3²) anew each time; the crossover
/// rate is drawn around the mean of those that succeeded, and the strategies are used in proportion
/// to their success over the last generations.
///
/// Throws std::invalid_argument for a dimension or an option out of range.
[[nodiscard]] Optimum maximise_by_differential_evolution(const Objective& objective, int dimension,
                                                         const SadeOptions& options);

}  // namespace wheeltap::inference
