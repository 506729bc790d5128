#include "identification/findings/prior_bound.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "identification/findings/marginal.hpp"

namespace wheeltap::identification {
namespace {

constexpr double kOuter = 1.645;  // standard normal: the prior's outer 5 %
constexpr double kShare = 0.25;
constexpr double kTouches = 0.05;

}  // namespace

PriorBound bound_of(const inference::Prior& prior, std::span<const double> draws,
                    std::span<const double> weights) {
  const auto piles_up = [&](double bound, double outer) {
    if (!std::isfinite(bound)) return false;
    std::vector<std::pair<double, double>> distances;
    double beyond = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < draws.size(); ++i) {
      const double weight = weights.empty() ? 1.0 : weights[i];
      const double distance = std::abs(draws[i] - bound);
      sum += weight;
      if (distance < std::abs(outer - bound)) beyond += weight;
      distances.emplace_back(distance, weight);
    }
    if (!(beyond > kShare * sum)) return false;
    return weighted_quantile(distances, 0.025) < kTouches * weighted_quantile(distances, 0.975);
  };
  if (piles_up(prior.upper(), prior.from_standard_normal(kOuter))) return PriorBound::upper;
  if (prior.lower() != 0.0 && piles_up(prior.lower(), prior.from_standard_normal(-kOuter)))
    return PriorBound::lower;
  return PriorBound::none;
}

}  // namespace wheeltap::identification
