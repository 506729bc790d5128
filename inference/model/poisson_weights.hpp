// The Poisson prior of a count:  P(k) = m^k e^-m / k!,  here from `min` to `max`.
#pragma once

#include <cmath>
#include <vector>

#include "base/log_gamma.hpp"

namespace wheeltap::inference {

/// Returns the weights P(min), …, P(max) for the mean m > 0. The sum of the weights is below 1.
[[nodiscard]] inline std::vector<double> poisson_weights(double mean, int min, int max) {
  std::vector<double> weights;
  for (int k = min; k <= max; ++k)
    weights.push_back(std::exp(k * std::log(mean) - base::log_gamma(k + 1.0) - mean));
  return weights;
}

}  // namespace wheeltap::inference
