// Minimal implementations of five methods to sample Beta(2, 3): importance, rejection, Gibbs,
// Metropolis-Hastings and slice sampling.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "base/random.hpp"

namespace wheeltap::examples {

using base::Random;

/// p(μ) = Γ(5) / (Γ(2) Γ(3)) μ (1 - μ)² = 12 μ (1 - μ)² on [0, 1].
inline double beta_density(double mu) {
  return mu < 0.0 || mu > 1.0 ? 0.0 : 12.0 * mu * (1.0 - mu) * (1.0 - mu);
}

inline constexpr double kProposalMean = 0.4, kProposalSd = 0.2;

/// The proposal of importance and rejection sampling, N(0.4, 0.2²).
inline double proposal_density(double mu) {
  const double u = (mu - kProposalMean) / kProposalSd;
  return std::exp(-0.5 * u * u) / (std::sqrt(2.0 * std::numbers::pi) * kProposalSd);
}

/// The function f(μ) = μ³ + μ² + 4μ + 0.2. Its expectation under Beta(2, 3) is 2.1142857.
inline double polynomial(double mu) {
  return ((mu + 1.0) * mu + 4.0) * mu + 0.2;
}

/// The smallest j with p <= j · proposal density on [0, 1]. The ratio of the two densities is
/// bounded on [0, 1], so j exists, although the proposal density is below p at some points.
inline double envelope_factor() {
  constexpr int kPoints = 100000;
  double most = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const double mu = static_cast<double>(i) / kPoints;
    most = std::max(most, beta_density(mu) / proposal_density(mu));
  }
  return most * (1.0 + 1e-8);  // covers the relative error of the maximum on the grid
}

struct WeightedMean {
  double mean, standard_error, effective_draws;
};

/// Estimates E[f] by Σ w f / Σ w over draws of the proposal; w = p / proposal density.
inline WeightedMean importance(const std::function<double(double)>& f, int n,
                               base::Random& random) {
  double sum = 0.0, squares = 0.0, weighted = 0.0;
  std::vector<double> w, value;
  for (int i = 0; i < n; ++i) {
    const double mu = kProposalMean + kProposalSd * random.normal();
    w.push_back(beta_density(mu) / proposal_density(mu));
    value.push_back(f(mu));
    sum += w.back();
    squares += w.back() * w.back();
    weighted += w.back() * value.back();
  }
  const double mean = weighted / sum;
  double variance = 0.0;  // variance of the ratio, by the delta method
  for (std::size_t i = 0; i < w.size(); ++i)
    variance += std::pow(w[i] / sum * (value[i] - mean), 2.0);
  return {mean, std::sqrt(variance), sum * sum / squares};
}

/// Accepts draws of the proposal with probability p / (j · proposal density); draws are
/// independent.
inline std::vector<double> rejection(int n, base::Random& random) {
  const double j = envelope_factor();
  std::vector<double> draws;
  while (static_cast<int>(draws.size()) < n) {
    const double mu = kProposalMean + kProposalSd * random.normal();
    if (random.uniform() * j * proposal_density(mu) < beta_density(mu)) draws.push_back(mu);
  }
  return draws;
}

/// Draws two components of Dirichlet(2, 1, 2) in turn, each given the other. The first component
/// has the distribution Beta(2, 3):
///
///   μ₁ | μ₂ ~ (1 - μ₂) Beta(2, 2),   μ₂ | μ₁ ~ (1 - μ₁) Beta(1, 2).
///
/// (With only two components, each would determine the other, because their sum is one. Neither
/// component could then change.)
inline std::vector<double> gibbs(int n, base::Random& random) {
  const auto beta = [&](double a, double b) {
    const double x = random.gamma(a), y = random.gamma(b);
    return x / (x + y);
  };
  std::vector<double> draws;
  double first = 0.5, second = 0.25;
  for (int i = 0; i < n; ++i) {
    first = (1.0 - second) * beta(2.0, 2.0);
    second = (1.0 - first) * beta(1.0, 2.0);
    draws.push_back(first);
  }
  return draws;
}

/// Normal random walk with standard deviation `width`; a rejection repeats the previous draw.
inline std::vector<double> metropolis_hastings(const std::function<double(double)>& density,
                                               double start, double width, int n,
                                               base::Random& random) {
  std::vector<double> draws;
  double mu = start;
  for (int i = 0; i < n; ++i) {
    const double to = mu + width * random.normal();
    if (random.uniform() * density(mu) < density(to)) mu = to;
    draws.push_back(mu);
  }
  return draws;
}

/// Slice sampling (Neal 2003, Annals of Statistics 31:705). The function draws a height below the
/// density, widens an interval until the density is below this height at both ends, and draws from
/// the interval. A draw whose density is below the height becomes an end of the interval.
inline std::vector<double> slice(const std::function<double(double)>& density, double start,
                                 double width, int n, base::Random& random) {
  std::vector<double> draws;
  double mu = start;
  for (int i = 0; i < n; ++i) {
    const double height = random.uniform() * density(mu);
    double low = mu - width * random.uniform(), high = low + width;
    while (density(low) > height) low -= width;
    while (density(high) > height) high += width;
    for (;;) {
      const double to = low + (high - low) * random.uniform();
      if (density(to) > height) {
        mu = to;
        break;
      }
      (to < mu ? low : high) = to;
    }
    draws.push_back(mu);
  }
  return draws;
}

}  // namespace wheeltap::examples
