// What draws of a system identification predict, beside what was measured.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// Residuals [SI] of draws spread evenly over the run, for predictive checks.
struct SidPredictive {
  struct Draw {
    std::size_t chain = 0, draw = 0;
    std::vector<float> residuals;  ///< channel by channel, scored samples only
    std::vector<double> noise;     ///< sd, one a channel
  };
  std::vector<Draw> draws;
};

/// At most `draws` of them, fewer for long records; in proportion to what they count where models
/// were balanced, so that all of them count the same.
[[nodiscard]] SidPredictive predict(const SidProblem& problem,
                                    const inference::Posterior& posterior, int draws = 200);

/// The scored samples of a response channel in SI units, under these parameters of the case.
[[nodiscard]] std::vector<double> observed(const SidProblem& problem, std::size_t response,
                                           std::span<const double> theta);

/// Quantiles over the draws of what they predict for a response without its noise [SI], one a
/// scored sample: replicates scatter by the noise as well, and a median of them is as jagged.
struct NoiseFree {
  std::vector<double> q2_5, q50, q97_5;
};
/// One a response; empty without draws.
[[nodiscard]] std::vector<NoiseFree> noise_free(const SidProblem& problem,
                                                const inference::Posterior& posterior,
                                                const SidPredictive& predictive);

/// Share of each response's samples that lie within the central band `SidCase::band` of the
/// predictive mixture
///
///   1/D Σ_d N(prediction_d, σ_d²):
///
/// their probability integral transform lies within the level.
[[nodiscard]] std::vector<double> coverage(const SidProblem& problem,
                                           const SidPredictive& predictive);

}  // namespace wheeltap::identification
