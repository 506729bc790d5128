#include "inference/evidence/approximate_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace wheeltap::inference {
namespace {

double square(std::span<const double> z) {
  double sum = 0.0;
  for (const double v : z) sum += v * v;
  return sum;
}

// Draws a component with the probability that it generated z.
int component_at(const NormalMixture& mixture, std::span<const double> z, base::Random& random) {
  std::vector<double> weights(static_cast<std::size_t>(mixture.size()));
  mixture.component_log_densities(z, weights);
  const double top = *std::ranges::max_element(weights);
  if (!(top > -std::numeric_limits<double>::infinity())) return mixture.sample_component(random);
  double sum = 0.0;
  for (double& w : weights) sum += w = std::exp(w - top);
  double rest = random.uniform() * sum;
  int k = 0;
  while (k + 1 < mixture.size() && rest >= weights[static_cast<std::size_t>(k)])
    rest -= weights[static_cast<std::size_t>(k++)];
  return k;
}

}  // namespace

double SweepProposal::operator()(std::span<const double> z, base::Random& random,
                                 std::span<double> normal, std::span<double> to) const {
  if (kind == Kind::renewal) {
    mixture.sample(random, to);
    return mixture.log_density(z) - mixture.log_density(to);
  }
  if (kind == Kind::contraction) {
    const int k = component_at(mixture, z, random);
    const double kept = std::sqrt(std::max(0.0, 1.0 - scale * scale));
    mixture.standardise(k, z, normal);
    for (double& u : normal) u = kept * u + scale * random.normal();
    mixture.unstandardise(k, normal, to);
    return mixture.log_density(z) - mixture.log_density(to);
  }
  const NormalMixture::Component& c = mixture[mixture.sample_component(random)];
  for (double& v : normal) v = random.normal();
  const auto d = static_cast<int>(z.size());
  const double share = random.uniform() < 0.5 ? 1.0 : std::pow(d, -random.uniform());
  const double step = scale / std::sqrt(share);
  const auto one = static_cast<std::size_t>(random.index(d));
  for (std::size_t i = 0; i < z.size(); ++i) {
    to[i] = z[i];
    if (i != one && random.uniform() >= share) continue;
    double e = 0.0;
    for (std::size_t j = 0; j <= i; ++j)
      e += c.factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * normal[j];
    to[i] += step * e;
  }
  return 0.0;
}

int step_by_approximation(const LogApproximation& approximation, double beta,
                          const SweepProposal& propose, int steps, base::Random& random,
                          std::vector<double>& z, double& at) {
  std::vector<double> normal(z.size()), to(z.size());
  int accepted = 0;
  for (int step = 0; step < steps; ++step) {
    const double log_ratio = propose(z, random, normal, to);
    const double there = approximation(to);
    const double log_target = 0.5 * (square(z) - square(to)) + beta * (there - at);
    if (!(std::log(random.uniform()) < log_ratio + log_target)) continue;
    z = to;
    at = there;
    ++accepted;
  }
  return accepted;
}

}  // namespace wheeltap::inference
