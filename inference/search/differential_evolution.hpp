// Self-adaptive differential evolution (SADE): global maximisation without tuning.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "inference/search/optimum.hpp"

namespace wheeltap::inference {

struct SadeOptions {
  std::uint64_t seed = 1;
  int population = 0;  ///< size of the population; 0: 10 per dimension, at least 30
  int generations = 1000;
  double start_sd = 1.0;                        ///< the first population is N(0, start_sd² I)
  std::vector<std::vector<double>> start = {};  ///< first members of the first population, if not
                                                ///< empty
  double bound = std::numeric_limits<double>::infinity();  ///< bound at which |z_i| is reflected
  /// The search stops if the best and the worst value of the
  /// population differ by less than
  /// `tolerance`.
  double tolerance = 1e-9;
};

/// Maximises by differential evolution with self-adaptive control parameters (Qin & Suganthan 2005,
/// IEEE CEC 2:1785). Each trial vector comes from one of
///
///   rand/1:             v = z_a + F (z_b - z_c),
///   current-to-best/2:  v = z_i + F (z_best - z_i) + F (z_a - z_b),
///
/// with binomial crossover with z_i. The trial vector replaces z_i if its value is not lower. F ~
/// N(0.5, 0.3²) is drawn for each trial. The crossover rate is drawn around the mean of the
/// successful crossover rates. The probability of each of the two strategies is proportional to its
/// success rate in the most recent generations.
///
/// Throws std::invalid_argument for a dimension or an option out of range.
[[nodiscard]] Optimum maximise_by_differential_evolution(const Objective& objective, int dimension,
                                                         const SadeOptions& options);

}  // namespace wheeltap::inference
