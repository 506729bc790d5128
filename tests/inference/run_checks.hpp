// Checks of whole runs against exact results.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {

// Tolerances in Monte Carlo standard errors: false-alarm rate 10⁻⁶ per comparison.
inline constexpr double kSigmas = 4.9;

inline ChainsOf indicator(const Posterior& posterior, int model) {
  return posterior.indicator(model);
}

inline double probability(const Posterior& posterior, int model) {
  return mean(posterior.indicator(model));
}

inline void expect_probability(const Posterior& posterior, int model, double exact) {
  const ChainsOf chains = indicator(posterior, model);
  const double error = mcse_mean(chains);
  EXPECT_NEAR(mean(chains), exact, kSigmas * error + 1e-12)
      << (*posterior.space)[model].name << ", standard error " << error;
}

// Kolmogorov-Smirnov test of the functional f(x) of one model's draws, thinned to their effective
// size, against F.
template <typename F>
double ks_of_draws(const Posterior& posterior, int model, int parameter, F&& cdf) {
  ChainsOf chains;
  std::size_t shortest = std::numeric_limits<std::size_t>::max();
  for (const Chain& chain : posterior.chains) {
    auto& values = chains.emplace_back();
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Draw draw = chain.draw(i, *posterior.space);
      if (draw.model == model)
        values.push_back(cdf(draw.theta[static_cast<std::size_t>(parameter)]));
    }
    shortest = std::min(shortest, values.size());
  }
  std::vector<double> all;
  for (auto& values : chains) {
    values.resize(shortest);
    all.insert(all.end(), values.begin(), values.end());
  }
  const double effective = std::min(ess_mean(chains), static_cast<double>(all.size()));
  std::sort(all.begin(), all.end());
  double largest = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    largest = std::max(
        {largest, std::abs(all[i] - static_cast<double>(i) / static_cast<double>(all.size())),
         std::abs(all[i] - static_cast<double>(i + 1) / static_cast<double>(all.size()))});
  }
  const double t = std::sqrt(effective) * largest;
  return std::min(1.0, 2.0 * std::exp(-2.0 * t * t));
}

inline Options small(std::uint64_t seed = 1) {
  return {.seed = seed, .warmup = 3000, .draws = 6000};
}

}  // namespace wheeltap::inference
