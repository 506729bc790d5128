// Fit of a model to the record: forward simulations, their residuals, and their integration errors.
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

/// Ljung & Box's test of whiteness of the residuals of a response or, if the residual model is not
/// white, of the innovations.
struct ResidualWhiteness {
  bool of_innovations = false;
  int lags = 0;
  signals::Whiteness test;
  double lag_1 = 0.0;  ///< autocorrelation at lag 1
  int worst_lag = 1;   ///< lag of the largest autocorrelation
  double worst = 0.0;

  [[nodiscard]] bool white() const { return test.p_value >= kMisfit; }
};

/// Fit of a model to one response by a forward simulation, with residuals r = measured - predicted
/// [SI].
struct ChannelFit {
  std::string channel;
  int mass = 0;
  double mse = 0.0, rmse = 0.0;  ///< mean square error Σ r² / N, and its square root
  double nrmse = 0.0;            ///< √(Σ r² / Σ (y - ȳ)²); NaN for a constant record
  double r2 = 0.0;               ///< coefficient of determination 1 - nrmse²; NaN if nrmse is NaN
  double noise_sd = 0.0;         ///< standard deviation of the noise, as in the model
  std::optional<ResidualWhiteness> whiteness;  ///< test of whiteness; empty for too few samples
  /// The same test, applied to the residuals instead of the innovations; equals `whiteness` if the
  /// residual model is white.
  std::optional<ResidualWhiteness> plain_whiteness;
};

/// Simulates the model with the parameters `theta` of the case. The result has one entry per
/// response and is empty if the simulation fails.
[[nodiscard]] std::vector<ChannelFit> forward_run(const SidProblem& problem, int model,
                                                  std::span<const double> theta);

/// Returns a problem whose likelihood contains only the samples after the window (SidCase::beyond).
/// The motion is integrated through the window. Returns null if the record has no samples after the
/// window.
[[nodiscard]] std::unique_ptr<const SidProblem> continuation(const SidProblem& problem);

/// Returns the mean of a model's draws. The next function returns the draw with the highest
/// posterior density.
[[nodiscard]] std::vector<double> mean_draw(const SidProblem& problem,
                                            const inference::Posterior& posterior, int model);
[[nodiscard]] std::span<const double> best_draw(const SidProblem& problem,
                                                const inference::Posterior& posterior, int model);

/// Returns the parameters of the case at the posterior mean of a model with draws.
[[nodiscard]] std::vector<double> posterior_mean(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int model);

/// Returns the effect of the integration time step on the response at the best draw of a model,
/// relative to the noise sd σ: ‖(r - r') / σ‖ over all samples and channels. The residual r
/// belongs to the time step of the run, r' to a quarter of this time step.
///
/// The residual model whitens r - r'. To first order, the error of each parameter due to the time
/// step is at most this norm times the posterior sd of the parameter. The result is empty if the
/// solution is exact, or if shorter steps would exceed the maximum number of steps.
[[nodiscard]] std::optional<double> step_error(const SidProblem& problem,
                                               const inference::Posterior& posterior, int model);
/// Step errors above this value are reported.
inline constexpr double kLargestStepError = 0.3;

}  // namespace wheeltap::identification
