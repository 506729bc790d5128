#include "identification/findings/marginal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"

namespace wheeltap::identification {
namespace {

using inference::ChainsOf;
using inference::Posterior;

constexpr std::size_t kLeastDraws = 100;  // per chain, to diagnose convergence

// Midpoint of the bin with most draws, bins by Freedman & Diaconis (1981). `weights` may be empty.
double histogram_mode(const std::vector<double>& values, const std::vector<double>& weights,
                      double low, double high, double interquartile) {
  if (!(high > low)) return low;
  const double width = 2.0 * interquartile / std::cbrt(static_cast<double>(values.size()));
  const double bins_wanted = width > 0.0 ? std::ceil((high - low) / width) : 200.0;
  const auto bins = static_cast<std::size_t>(std::clamp(bins_wanted, 10.0, 400.0));
  std::vector<double> counts(bins);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto at =
        static_cast<std::size_t>((values[i] - low) / (high - low) * static_cast<double>(bins));
    counts[std::min(at, bins - 1)] += weights.empty() ? 1.0 : weights[i];
  }
  const auto fullest = std::ranges::max_element(counts) - counts.begin();
  return low + (static_cast<double>(fullest) + 0.5) * (high - low) / static_cast<double>(bins);
}

// Thins chains evenly to the same length; omits chains with too few draws.
ChainsOf equal_lengths(const ChainsOf& chains) {
  std::size_t n = std::numeric_limits<std::size_t>::max();
  for (const auto& chain : chains) {
    if (chain.size() >= kLeastDraws) n = std::min(n, chain.size());
  }
  ChainsOf out;
  for (const auto& chain : chains) {
    if (chain.size() < kLeastDraws) continue;
    out.emplace_back(n);
    for (std::size_t i = 0; i < n; ++i) out.back()[i] = chain[i * chain.size() / n];
  }
  return out;
}

}  // namespace

double quantile(const std::vector<double>& sorted, double p) {
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double weighted_quantile(std::vector<std::pair<double, double>> draws, double p) {
  std::ranges::sort(draws);
  // Cumulative weight at the middle of each draw, mapped to 0 for the first and 1 for the last.
  const double first = 0.5 * draws.front().second;
  double total = -first - 0.5 * draws.back().second;
  for (const auto& [x, w] : draws) total += w;
  double before = -first, last_x = draws.front().first, last_at = 0.0;
  for (const auto& [x, w] : draws) {
    const double at = before + 0.5 * w;
    if (at >= p * total) {
      return at > last_at ? last_x + (p * total - last_at) / (at - last_at) * (x - last_x) : x;
    }
    before += w;
    last_x = x, last_at = at;
  }
  return draws.back().first;
}

std::vector<double> model_weights(const Posterior& posterior) {
  const auto n = static_cast<std::size_t>(posterior.space->size());
  if (posterior.log_weight.empty()) return std::vector<double>(n, 1.0);
  const double top = std::ranges::max(posterior.log_weight);
  std::vector<double> weights;
  for (const double l : posterior.log_weight) weights.push_back(std::exp(l - top));
  double sum = 0.0, draws = 0.0;
  for (const auto& chain : posterior.chains) {
    for (const int m : chain.model) sum += weights[static_cast<std::size_t>(m)];
    draws += static_cast<double>(chain.model.size());
  }
  for (double& w : weights) w *= draws / sum;
  return weights;
}

ChainsOf draw_weights(const Posterior& posterior) {
  if (posterior.log_weight.empty()) return {};
  const std::vector<double> of_model = model_weights(posterior);
  return all_draws(posterior, [&](std::size_t c, std::size_t i) {
    return of_model[static_cast<std::size_t>(posterior.chains[c].model[i])];
  });
}

Marginal marginal(const ChainsOf& chains, const ChainsOf& weights) {
  std::vector<double> values, weight;
  for (const auto& chain : chains) values.insert(values.end(), chain.begin(), chain.end());
  for (const auto& chain : weights) weight.insert(weight.end(), chain.begin(), chain.end());
  const auto n = static_cast<double>(values.size());
  const auto w = [&](std::size_t i) { return weight.empty() ? 1.0 : weight[i]; };
  double total = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) total += w(i), mean += w(i) * values[i];
  mean /= total;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) squares += w(i) * std::pow(values[i] - mean, 2.0);
  std::vector<double> q;
  const std::vector<double> levels = {0.0, 0.025, 0.25, 0.5, 0.75, 0.975, 1.0};
  if (weight.empty()) {
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    for (const double p : levels) q.push_back(quantile(sorted, p));
  } else {
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t i = 0; i < values.size(); ++i) pairs.emplace_back(values[i], weight[i]);
    for (const double p : levels) q.push_back(weighted_quantile(pairs, p));
  }
  inference::Convergence judged{kNaN, kNaN, kNaN, kNaN, kNaN};
  double mcse_sd = kNaN;
  if (const ChainsOf equal = equal_lengths(chains); !equal.empty()) {
    judged = inference::convergence(equal);
    mcse_sd = inference::mcse_sd(equal);
  }
  const double sd = std::sqrt(squares / total);
  if (!weight.empty()) {
    // Weighted averages have the error of the mean of their influence values (delta method).
    const auto error_of = [&](const auto& influence) {
      ChainsOf values_of;
      std::size_t i = 0;
      for (const auto& chain : chains) {
        values_of.emplace_back();
        for (const double x : chain) values_of.back().push_back(w(i++) * influence(x) * n / total);
      }
      const ChainsOf equal = equal_lengths(values_of);
      return equal.empty() ? kNaN : inference::convergence(equal).mcse_mean;
    };
    judged.mcse_mean = error_of([&](double x) { return x - mean; });
    mcse_sd =
        sd > 0.0
            ? error_of([&](double x) { return (std::pow(x - mean, 2) - sd * sd) / (2.0 * sd); })
            : kNaN;
  }
  return {.mean = mean,
          .sd = n > 1.0 ? sd * std::sqrt(n / (n - 1.0)) : 0.0,
          .q2_5 = q[1],
          .q50 = q[3],
          .q97_5 = q[5],
          .mode = histogram_mode(values, weight, q.front(), q.back(), q[4] - q[2]),
          .ess_bulk = judged.ess_bulk,
          .ess_tail = judged.ess_tail,
          .rhat = judged.rhat,
          .mcse_mean = judged.mcse_mean,
          .mcse_sd = mcse_sd};
}

}  // namespace wheeltap::identification
