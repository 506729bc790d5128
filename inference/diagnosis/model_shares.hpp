// Fraction of the draws in each model, and the model probabilities computed from these
// fractions.
//
//   P_m ≈ w_m s_m / Σ_k w_k s_k,
//
// where s_m is the fraction of the draws in model m, and w_m is the weight of a draw of model m.
#pragma once

#include <vector>

#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference {

struct ModelShares {
  std::vector<std::vector<long>> counts;  ///< number of draws, chains × models
  std::vector<double> visits;             ///< fraction s of the draws in each model
  std::vector<double> weight;             ///< weight w, scaled to the mean 1 over the draws
  /// Weighted fraction of the draws in each model: the estimated model probability
  std::vector<double> share;
  std::vector<double> error;  ///< Monte Carlo standard error of `share`
};

/// `error` of model m is the standard error of the mean of w (i_m - P_m) over the draws, with w
/// scaled to the mean 1 (delta method). i_m is 1 for the draws of model m, otherwise 0.
[[nodiscard]] ModelShares model_shares(const Posterior& posterior);

/// Collects value(draw) for every draw, one list per chain.
template <class Value>
[[nodiscard]] ChainsOf of_all_draws(const Posterior& posterior, const Value& value) {
  ChainsOf out(posterior.chains.size());
  for (std::size_t c = 0; c < out.size(); ++c) {
    const Chain& chain = posterior.chains[c];
    out[c].resize(chain.size());
    for (std::size_t i = 0; i < out[c].size(); ++i) out[c][i] = value(posterior.draw(c, i));
  }
  return out;
}

}  // namespace wheeltap::inference
