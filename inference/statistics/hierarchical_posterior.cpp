#include "inference/statistics/hierarchical_posterior.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kNodes = 600;                  // number of nodes of τ
constexpr double kNegligibleWeight = 1e-10;  // smallest weight of a node

/// Σ w, y̅ = Σ w y / Σ w and Σ w (y - y̅)², w = 1 / (s² + τ²), over the groups with information.
struct Pooled {
  double weight = 0.0, mean = 0.0, squares = 0.0, log_weights = 0.0;
  int groups = 0;

  Pooled(std::span<const GroupEstimate> all, double tau) {
    for (const GroupEstimate& g : all) {
      if (!std::isfinite(g.sd)) continue;
      const double w = 1.0 / (g.sd * g.sd + tau * tau);
      ++groups;
      weight += w;
      mean += w * g.mean;
      log_weights += std::log(w);
    }
    mean /= weight;
    for (const GroupEstimate& g : all) {
      if (std::isfinite(g.sd)) squares += std::pow(g.mean - mean, 2) / (g.sd * g.sd + tau * tau);
    }
  }
};

}  // namespace

double LineMixture::cdf(double x) const {
  double sum = 0.0;
  for (const Component& c : components_) sum += c.weight * normal_cdf((x - c.mean) / c.sd);
  return sum;
}

double LineMixture::quantile(double p) const {
  if (!(p > 0.0 && p < 1.0))
    throw std::invalid_argument("quantile of p = " + std::to_string(p) + ", must be in (0, 1)");
  const double z = normal_quantile(p);
  double low = components_.front().mean + z * components_.front().sd, high = low;
  for (const Component& c : components_) {
    low = std::min(low, c.mean + z * c.sd);
    high = std::max(high, c.mean + z * c.sd);
  }
  // The start interval is that of the components' quantiles.
  for (int halving = 0; halving < 60 && high > low; ++halving) {
    const double middle = 0.5 * (low + high);
    (cdf(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double LineMixture::expectation(const std::function<double(double)>& f) const {
  // The error of the trapezoidal rule for a normal is e^{-2π²/h²} (Trefethen & Weideman 2014).
  constexpr double kStep = 0.5;
  constexpr int kReach = 14;
  double sum = 0.0;
  for (const Component& c : components_) {
    double inner = 0.0, weights = 0.0;
    for (int i = -kReach; i <= kReach; ++i) {
      const double z = kStep * i, w = std::exp(-0.5 * z * z);
      weights += w;
      inner += w * f(c.mean + c.sd * z);
    }
    sum += c.weight * inner / weights;
  }
  return sum;
}

HierarchicalPosterior hierarchical_posterior(std::span<const GroupEstimate> groups,
                                             const HierarchicalOptions& options) {
  for (const GroupEstimate& g : groups)
    if (!(g.sd > 0.0) || !std::isfinite(g.mean))
      throw std::invalid_argument("hierarchical posterior: a group's sd = " + std::to_string(g.sd) +
                                  " must be positive and its mean finite");
  if (!(options.centre_sd > 0.0 && options.largest_scatter > 0.0))
    throw std::invalid_argument(
        "hierarchical posterior: centre_sd and largest_scatter must be > 0");
  double precision = 0.0;
  int informed = 0;
  for (const GroupEstimate& g : groups) {
    if (!std::isfinite(g.sd)) continue;
    ++informed;
    precision += 1.0 / (g.sd * g.sd);
  }
  if (informed < 2)
    throw std::invalid_argument("hierarchical posterior: " + std::to_string(informed) +
                                " groups with a finite sd, but at least 2 are required");
  const double lambda = std::sqrt(informed / precision);
  const double v0 = options.centre_sd * options.centre_sd, m0 = options.centre_mean;
  const double range = std::log1p(options.largest_scatter / lambda);

  std::vector<double> tau(kNodes), log_weight(kNodes), mean(kNodes), variance(kNodes);
  for (std::size_t i = 0; i < tau.size(); ++i) {
    tau[i] = lambda * std::expm1(range * (static_cast<double>(i) + 0.5) / kNodes);
    const Pooled pooled(groups, tau[i]);
    const double v = 1.0 / (pooled.weight + 1.0 / v0);
    variance[i] = v;
    mean[i] = v * (pooled.weight * pooled.mean + m0 / v0);
    log_weight[i] = 0.5 * (pooled.log_weights - pooled.squares + std::log(v) -
                           std::pow(pooled.mean - m0, 2) / (v0 + 1.0 / pooled.weight));
  }
  const double top = std::ranges::max(log_weight);
  double total = 0.0;
  for (double& l : log_weight) total += l = std::exp(l - top);

  std::vector<LineMixture::Component> centre, group, estimate;
  std::vector<double> scatter, weight;
  for (std::size_t i = 0; i < tau.size(); ++i) {
    const double w = log_weight[i] / total;
    if (w < kNegligibleWeight) continue;
    scatter.push_back(tau[i]);
    weight.push_back(w);
    const double of_group = variance[i] + tau[i] * tau[i];
    centre.push_back({w, mean[i], std::sqrt(variance[i])});
    group.push_back({w, mean[i], std::sqrt(of_group)});
    estimate.push_back({w, mean[i], std::sqrt(of_group + lambda * lambda)});
  }
  return {.centre = LineMixture(std::move(centre)),
          .group = LineMixture(std::move(group)),
          .estimate = LineMixture(std::move(estimate)),
          .scatter = std::move(scatter),
          .weight = std::move(weight),
          .own_error = lambda,
          .groups = informed};
}

BirgeRatio birge_ratio(std::span<const GroupEstimate> groups) {
  const Pooled pooled(groups, 0.0);
  if (pooled.groups < 2) return {};
  const double freedom = pooled.groups - 1;
  return {.ratio = std::sqrt(pooled.squares / freedom),
          .p_value = boost::math::gamma_q(0.5 * freedom, 0.5 * pooled.squares)};
}

}  // namespace wheeltap::inference
