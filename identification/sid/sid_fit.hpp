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

/// Ljung & Box's test for the residuals of a response or, if its residual model is not white, for
/// the innovations.
struct ResidualWhiteness {
  bool of_innovations = false;
  int lags = 0;
  signals::Whiteness test;
  double lag_1 = 0.0;  ///< autocorrelation
  int worst_lag = 1;   ///< lag of the largest autocorrelation
  double worst = 0.0;

  [[nodiscard]] bool white() const { return test.p_value >= kMisfit; }
};

/// A forward run of a model for one response, r = measured - predicted [SI].
struct ChannelFit {
  std::string channel;
  int mass = 0;
  double mse = 0.0, rmse = 0.0;  ///< Σ r² / N, and its root
  double nrmse = 0.0;            ///< √(Σ r² / Σ (y - ȳ)²); NaN for a constant record
  double r2 = 0.0;               ///< 1 - nrmse²; NaN if nrmse is
  double noise_sd = 0.0;         ///< noise of the model
  std::optional<ResidualWhiteness> whiteness;  ///< empty for too few samples
  /// For the residuals themselves; equals `whiteness` if the residual model is white.
  std::optional<ResidualWhiteness> plain_whiteness;
};

/// One entry per response; empty if the simulation fails. `theta`: parameters of the case.
[[nodiscard]] std::vector<ChannelFit> forward_run(const SidProblem& problem, int model,
                                                  std::span<const double> theta);

/// A problem that integrates through the window without scoring and scores the samples after it
/// (SidCase::beyond); null if there are none.
[[nodiscard]] std::unique_ptr<const SidProblem> continuation(const SidProblem& problem);

/// The mean of a drawn model's draws, and its draw with the highest posterior density.
[[nodiscard]] std::vector<double> mean_draw(const SidProblem& problem,
                                            const inference::Posterior& posterior, int model);
[[nodiscard]] std::span<const double> best_draw(const SidProblem& problem,
                                                const inference::Posterior& posterior, int model);

/// Parameters of the case at the posterior mean of a drawn model.
[[nodiscard]] std::vector<double> posterior_mean(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int model);

/// The effect of the integrator's step length on the response of a drawn model's best draw,
/// relative to the noise,
///
///   ‖(r - r') / σ‖,  r' the residuals with steps a quarter as long,
///
/// over all samples and channels, as innovations of the residual model. To first order, no
/// parameter has an error of more than this number of its standard deviations. Empty if the
/// solution is exact, or if the shorter steps would exceed the largest number of steps.
[[nodiscard]] std::optional<double> step_error(const SidProblem& problem,
                                               const inference::Posterior& posterior, int model);
/// Limit of the step error; larger errors are reported.
inline constexpr double kLargestStepError = 0.3;

}  // namespace wheeltap::identification
