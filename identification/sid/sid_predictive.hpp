// Posterior predictions of a system identification.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// Residuals [SI] of draws spread evenly over the chains, for predictive checks.
struct SidPredictive {
  struct Draw {
    std::size_t chain = 0, draw = 0;
    std::vector<float> residuals;  ///< residuals of the scored samples, channel by channel
    std::vector<double> noise;     ///< standard deviation of the noise, one per channel
  };
  std::vector<Draw> draws;
};

/// Selects at most `draws` draws (fewer for long records) and computes their residuals. For
/// balanced models, draws are selected with probabilities proportional to their weights, so that
/// the selected draws have equal weights.
[[nodiscard]] SidPredictive predict(const SidProblem& problem,
                                    const inference::Posterior& posterior, int draws = 200);

/// Returns the scored samples of a response channel in SI units. The conversion uses the scale and
/// offset that belong to the parameters `theta` of the case.
[[nodiscard]] std::vector<double> observed(const SidProblem& problem, std::size_t response,
                                           std::span<const double> theta);

/// Quantiles over the draws of the predicted response without noise [SI], one per scored sample.
/// Curves that include noise would not be smooth.
struct NoiseFree {
  std::vector<double> q2_5, q50, q97_5;
};
/// Computes the quantiles in NoiseFree for each response. The result is empty without draws.
[[nodiscard]] std::vector<NoiseFree> noise_free(const SidProblem& problem,
                                                const inference::Posterior& posterior,
                                                const SidPredictive& predictive);

/// Fraction of the samples of each response inside the central interval of the predictive mixture
///
///   1/D Σ_d N(prediction_d, σ_d²).
///
/// The probability of the central interval is `SidCase::band`. The fraction is computed by the
/// probability integral transform.
[[nodiscard]] std::vector<double> coverage(const SidProblem& problem,
                                           const SidPredictive& predictive);

}  // namespace wheeltap::identification
