#include "inference/evidence/approximate_steps.hpp"

#include <cmath>

namespace wheeltap::inference {
namespace {

double square(std::span<const double> z) {
  double sum = 0.0;
  for (const double v : z) sum += v * v;
  return sum;
}

}  // namespace

double SweepProposal::operator()(std::span<const double> z, base::Random& random,
                                 std::span<double> normal, std::span<double> to) const {
  if (renew) {
    mixture.sample(random, to);
    return mixture.log_density(z) - mixture.log_density(to);
  }
  const NormalMixture::Component& c = mixture[mixture.sample_component(random)];
  for (double& v : normal) v = random.normal();
  const double scale = std::exp(log_scale);
  for (std::size_t i = 0; i < z.size(); ++i) {
    double e = 0.0;
    for (std::size_t j = 0; j <= i; ++j)
      e += c.factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * normal[j];
    to[i] = z[i] + scale * e;
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
