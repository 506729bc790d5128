// How well a model's own motion explains the record: forward runs, their residuals, and what the
// integrator's steps add to them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "identification/findings/fit_verdict.hpp"
#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "signals/residuals.hpp"

namespace wheeltap::identification {

/// Ljung & Box's test of a response's residuals, or of the innovations of a residual model that is
/// not white.
struct ResidualWhiteness {
  bool of_innovations = false;
  int lags = 0;
  signals::Whiteness test;
  double lag_1 = 0.0;  ///< autocorrelation
  int worst_lag = 1;   ///< of the largest autocorrelation, and its value
  double worst = 0.0;

  [[nodiscard]] bool white() const { return test.p_value >= kMisfit; }
};

/// A forward run of a model against one response, r = measured - predicted [SI].
struct ChannelFit {
  std::string channel;
  int mass = 0;
  double mse = 0.0, rmse = 0.0;  ///< Σ r² / N, and its root
  double nrmse = 0.0;            ///< √(Σ r² / Σ (y - ȳ)²); NaN for a constant record
  double r2 = 0.0;               ///< 1 - nrmse²; NaN with it
  double noise_sd = 0.0;         ///< the model's
  std::optional<ResidualWhiteness> whiteness;  ///< none for too few samples
  /// Of the residuals as they are; as `whiteness` where the residual model is white.
  std::optional<ResidualWhiteness> plain_whiteness;
};

/// One entry a response; empty where the response fails. `theta`: parameters of the case.
[[nodiscard]] std::vector<ChannelFit> forward_run(const SidProblem& problem, int model,
                                                  std::span<const double> theta);

/// The problem whose motion runs through the window, unscored, into the samples that follow it
/// (SidCase::beyond) and is scored there; null where none follow.
[[nodiscard]] std::unique_ptr<const SidProblem> continuation(const SidProblem& problem);

/// The mean of a drawn model's draws, and the draw that has the highest posterior density.
[[nodiscard]] std::vector<double> mean_draw(const SidProblem& problem,
                                            const inference::Posterior& posterior, int model);
[[nodiscard]] std::span<const double> best_draw(const SidProblem& problem,
                                                const inference::Posterior& posterior, int model);

/// Parameters of the case at the posterior mean of a drawn model.
[[nodiscard]] std::vector<double> posterior_mean(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int model);

/// What the length of the integrator's steps does to the response of a drawn model's best draw,
/// beside the noise:
///
///   ‖(r - r') / σ‖,  r' the residuals with steps a quarter as long,
///
/// over all samples and channels, as innovations of the residual model. To first
/// order no parameter is off by more than so many of its standard deviations. None where the
/// solution is exact or the finer steps would be too many.
[[nodiscard]] std::optional<double> step_error(const SidProblem& problem,
                                               const inference::Posterior& posterior, int model);
/// That a run may have before it says so.
inline constexpr double kLargestStepError = 0.3;

}  // namespace wheeltap::identification
