// Summary of the draws of one quantity: mean, standard deviation, quantiles and their errors.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::identification {

/// Summary of one quantity over all chains. The convergence values are NaN for chains of fewer than
/// 100 draws.
struct Marginal {
  double mean = 0.0;
  double sd = 0.0;
  double q2_5 = 0.0;  ///< quantiles of 2.5, 50 and 97.5 %
  double q50 = 0.0;
  double q97_5 = 0.0;
  /// Midpoint of the histogram bin with the most draws; bin width by Freedman & Diaconis (1981)
  double mode = 0.0;
  double ess_bulk = 0.0, ess_tail = 0.0, rhat = 0.0;
  /// Monte Carlo standard errors of `mean` and `sd`
  double mcse_mean = 0.0, mcse_sd = 0.0;

  /// Width of the 95 % credible interval
  [[nodiscard]] double width() const { return q97_5 - q2_5; }
};

/// Computes the summary from at least one draw. `weights` has one weight per draw; if it is empty,
/// all weights are equal.
[[nodiscard]] Marginal marginal(const inference::ChainsOf& chains,
                                const inference::ChainsOf& weights = {});

/// Quantile of sorted draws, interpolated linearly between order statistics.
[[nodiscard]] double quantile(const std::vector<double>& sorted, double p);
/// Weighted quantile of pairs (value, weight) in any order. The result equals `quantile` if all
/// weights are equal.
[[nodiscard]] double weighted_quantile(std::vector<std::pair<double, double>> draws, double p);

/// The weight that each draw of a model has; the average over all draws is 1. The weights differ
/// only with Options::balance (Posterior::log_weight). Averages over models must use the weights.
[[nodiscard]] std::vector<double> model_weights(const inference::Posterior& posterior);
/// The weight of every draw; empty if all weights are equal.
[[nodiscard]] inference::ChainsOf draw_weights(const inference::Posterior& posterior);

/// Collects `value(chain, draw)` for every draw of one model.
template <class Value>
[[nodiscard]] inference::ChainsOf draws_in_model(const inference::Posterior& posterior, int model,
                                                 const Value& value) {
  inference::ChainsOf out(posterior.chains.size());
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    const auto& models = posterior.chains[c].model;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i] == model) out[c].push_back(value(c, i));
    }
    posterior.chains[c].let_go();
  }
  return out;
}

/// Collects `value(chain, draw)` for every draw.
template <class Value>
[[nodiscard]] inference::ChainsOf all_draws(const inference::Posterior& posterior,
                                            const Value& value) {
  inference::ChainsOf out(posterior.chains.size());
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    out[c].resize(posterior.chains[c].model.size());
    for (std::size_t i = 0; i < out[c].size(); ++i) out[c][i] = value(c, i);
    posterior.chains[c].let_go();
  }
  return out;
}

}  // namespace wheeltap::identification
