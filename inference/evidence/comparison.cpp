#include "inference/evidence/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace wheeltap::inference {

ImpliedProbabilities implied_probabilities(const ModelSpace& space,
                                           const std::vector<Evidence>& evidences) {
  constexpr double kRounding = 1e-16;
  const auto n = static_cast<std::size_t>(space.size());
  if (evidences.size() != n)
    throw std::invalid_argument("implied probabilities: " + std::to_string(evidences.size()) +
                                " evidences, must be " + std::to_string(n));
  double top = -std::numeric_limits<double>::infinity();
  std::vector<double> log_p;
  for (std::size_t m = 0; m < n; ++m) {
    log_p.push_back(space[static_cast<int>(m)].log_prior + evidences[m].log_evidence);
    top = std::max(top, log_p.back());
  }
  ImpliedProbabilities result{log_p, std::vector<double>(n, 0.0)};
  double sum = 0.0;
  for (double& p : result.mean) sum += p = std::exp(p - top);
  for (double& p : result.mean) p /= sum;
  for (std::size_t m = 0; m < n; ++m) {
    // 1 - P(m), without cancellation for P(m) near 1
    double others = 0.0;
    for (std::size_t k = 0; k < n; ++k)
      if (k != m) others += result.mean[k];
    double variance = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      const double slope = result.mean[m] * (m == k ? others : -result.mean[k]);
      // An error that changes P(m) by less than rounding errors has no effect, even if it is NaN.
      if (slope == 0.0 || (std::abs(slope) < kRounding && std::isnan(evidences[k].standard_error)))
        continue;
      variance += std::pow(slope * evidences[k].standard_error, 2.0);
    }
    result.standard_error[m] = std::sqrt(variance);
  }
  return result;
}

std::vector<Disagreement> disagreements(const std::vector<double>& sampled,
                                        const std::vector<double>& sampled_error,
                                        const ImpliedProbabilities& implied, double sigmas,
                                        double least) {
  std::vector<Disagreement> out;
  for (std::size_t m = 0; m < sampled.size(); ++m) {
    const double error = std::hypot(sampled_error[m], implied.standard_error[m]);
    const double difference = std::fabs(sampled[m] - implied.mean[m]);
    if (!(difference > least && difference > sigmas * error)) continue;  // true for NaN, too
    out.push_back({.model = static_cast<int>(m),
                   .sampled = sampled[m],
                   .sampled_error = sampled_error[m],
                   .implied = implied.mean[m],
                   .implied_error = implied.standard_error[m]});
  }
  return out;
}

}  // namespace wheeltap::inference
