// What a system-identification run found: which model, with what parameters, and how well it
// explains the record.
#pragma once

#include <optional>

#include "apps/evidence.hpp"
#include "apps/sid_problem.hpp"
#include "apps/summary.hpp"

namespace wheeltap::apps {

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

/// Parameters of the case at the posterior mean of a visited model.
[[nodiscard]] std::vector<double> posterior_mean(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int model);

/// What the length of the integrator's steps does to the response of a visited model's best draw,
/// beside the noise:
///
///   ‖(r - r') / σ‖,  r' the residuals with steps a quarter as long,
///
/// over all samples and channels, freed of their autoregression where the model has one. To first
/// order no parameter is off by more than so many of its standard deviations. None where the
/// solution is exact or the finer steps would be too many.
[[nodiscard]] std::optional<double> step_error(const SidProblem& problem,
                                               const inference::Posterior& posterior, int model);
/// That a run may have before it says so.
inline constexpr double kLargestStepError = 0.3;

/// The whole of summary.json. `posterior` must have at least 4 draws a chain, all chains the same.
[[nodiscard]] Report summarise_sid(const SidProblem& problem, const inference::Posterior& posterior,
                                   const SidPredictive& predictive,
                                   const std::vector<MethodEvidence>& evidence,
                                   const RunInfo& info);

}  // namespace wheeltap::apps
