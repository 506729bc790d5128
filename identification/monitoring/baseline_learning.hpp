// Training of the baseline model: inference of its parameters from the training period.
//
// Reversible-jump MCMC (inference/) samples the nonlinear parameters: number and knots of hinges
// (trans-dimensional), the thermal lag, the rate of the fast drift and, for each feature, the drift
// variance relative to the noise. Coefficients and noise variances are integrated in closed form
// (marginal_likelihood.hpp). Three approximations reduce the run time:
//
// - outliers: the sampled likelihood is Gaussian with fixed weights (nu + 1)/(nu + r²), from the
//   residuals r of a preliminary robust fit with nu = 5. The degrees of freedom are then drawn from
//   a grid, weighted by the evidence of the exact filter.
// - the sampling treats features as independent. The correlation between the drifts of the features
//   is estimated from the residuals and multiplied by a factor of 0, 1/2 or 1. The factor is drawn
//   together with the degrees of freedom.
// - the lag is common to all covariates; the slow drift's relative variance is common to all
//   features.
//
// The full filter (baseline_filter.hpp) of each draw then processes the training rows, starting
// from the priors. The posterior of the coefficients is exact except for the filter's approximation
// of Student's t.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "identification/monitoring/baseline_filter.hpp"
#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

struct LearningOptions {
  /// Number of parameter draws kept for monitoring. 0: six, or four if all features have more than
  /// 80 coefficients in total (not counting the terms for weather outside the training period). If
  /// there are at most 1000 training entries, 0 means the quotient of 1000 and the number of
  /// coefficients, limited to the range from 6 (or 4) to 24.
  int draws = 0;
  int most_hinges = 3;  ///< largest number of hinges; all numbers have equal priors
  bool hinges = true, lag = true;
  std::vector<bool> may_hinge = {};  ///< true for covariates that may have hinges; empty: all
  std::uint64_t seed = 1;
  int threads = 1;
  int chains = 4;
  // Numbers of draws and of warm-up iterations; 0: the sampler chooses them.
  int engine_draws = 500, engine_warmup = 2000;  ///< numbers per chain; 0: automatic
  int searches = 1;
  std::function<bool(double fraction)> progress = nullptr;  ///< returns false to stop the training
};

/// One parameter draw, and the state of its filter after the training rows.
struct BaselineDraw {
  BaselineParameters parameters = {};
  BaselineFilter filter = {};
  /// Covariates of the last row, delayed by the thermal lag (`lagged`) or by the long lag (`slow`)
  Eigen::VectorXd lagged = {}, slow = {};
  /// Standard deviation of the error of `lagged` due to missing covariates
  Eigen::VectorXd lagged_error = {};
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, BaselineDraw>
void carry(Parcel& parcel, Of& draw) {
  parcel(draw.parameters, draw.filter, draw.lagged, draw.slow, draw.lagged_error);
}

/// The trained baseline.
struct Baseline {
  CovariateScaling scaling = {};
  Eigen::VectorXd usual_sds = {};    ///< p, or empty
  Eigen::VectorXd reference = {};    ///< medians of the p features in the training period
  Eigen::VectorXd residual_sd = {};  ///< posterior mean sd of drift and noise together, per feature
  std::vector<BaselineDraw> draws = {};
  double rows_per_hour = 1.0;
  double last_hours = 0.0;  ///< time of the last row that the filters processed
  // Nonlinear parameters of the draw with the highest posterior density, at which refit_baseline
  // starts; they are not stored with a state:
  std::vector<double> best = {};
  std::vector<int> hinged = {};  ///< covariates that may have hinges
  bool has_lag = false;
  // Convergence diagnostics of the sampling:
  std::vector<double> hinge_probability = {};  ///< probabilities of 0, 1, … hinges
  bool converged = false;
  double rhat_max = 1.0;  ///< largest R-hat of covariate effects, noise and drift
  long likelihood_evaluations = 0;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Baseline>
void carry(Parcel& parcel, Of& b) {
  parcel(b.scaling, b.usual_sds, b.reference, b.residual_sd, b.draws, b.rows_per_hour, b.last_hours,
         b.hinge_probability, b.converged, b.rhat_max, b.likelihood_evaluations);
}

/// Trains the baseline on all rows of `learning`. Throws std::invalid_argument if find_faults
/// reports a fault other than a constant covariate.
[[nodiscard]] Baseline learn_baseline(const Series& learning, const LearningOptions& options);

/// Trains a baseline with one draw on other training rows. An optimiser maximises the evidence over
/// the nonlinear parameters, starting at the best draw of `from`. Degrees of freedom and
/// correlation are those of the first draw of `from`. Throws the exceptions of learn_baseline.
[[nodiscard]] Baseline refit_baseline(const Series& learning, const Baseline& from,
                                      const LearningOptions& options);

/// Updates the lagged covariates of one draw; returns its regressors.
[[nodiscard]] Weather next_weather(const CovariateScaling::Scaled& scaled, double hours,
                                   BaselineDraw& draw);

inline constexpr double kLargestWeatherError = 0.3;
/// False if the error from missing covariates may shift a feature by more than kLargestWeatherError
/// times its residual standard deviation (`residual_sd`, p entries).
[[nodiscard]] bool is_weather_known(const BaselineDraw& draw, const Eigen::VectorXd& residual_sd);

}  // namespace wheeltap::identification::monitoring
