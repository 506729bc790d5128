// The baseline's parameters from the learning period.
//
// The engine samples what enters nonlinearly: number and knots of hinges (trans-dimensional), the
// thermal lag, the rate of the fast drift and, for each feature, its variance relative to noise.
// Coefficients and noise variances are integrated in closed form (marginal_likelihood.hpp). Three
// approximations make that affordable:
//
// - outliers: the engine's likelihood is Gaussian with fixed weights (nu + 1)/(nu + r²) of a
//   preliminary robust fit, nu = 5. The degrees of freedom are then drawn from the exact filter's
//   evidence over a grid.
// - features are independent in the engine; the correlation of their drift is estimated from the
//   residuals, and its share (0, 1/2 or 1 of it) is drawn with the degrees of freedom.
// - lag and the slow drift's relative variance are common to all covariates and features.
//
// The draws then run through the learning rows in the full filter (baseline_filter.hpp), from their
// priors: coefficients are known as exactly as that filter's approximation of Student's t allows.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "identification/monitoring/baseline_filter.hpp"
#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

struct LearningOptions {
  /// Parameter draws that are carried on; 0: six, or four where features have more than eighty
  /// coefficients in all, which the time of a row is proportional to.
  int draws = 0;
  int most_hinges = 3;  ///< prior: any number up to it is equally probable
  bool hinges = true, lag = true;
  std::vector<bool> may_hinge = {};  ///< one a covariate; empty: all
  std::uint64_t seed = 1;
  int threads = 1;
  int chains = 4;
  // Bounds on the engine's work; 0: as it chooses.
  int engine_draws = 500, engine_warmup = 2000;  ///< a chain
  int searches = 1;
  std::function<bool(double fraction)> progress = nullptr;  ///< false: stop early
};

/// One parameter draw with its filter, after the learning rows.
struct BaselineDraw {
  BaselineParameters parameters = {};
  BaselineFilter filter = {};
  Eigen::VectorXd lagged = {}, slow = {};  ///< covariates of the last row, by either lag
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, BaselineDraw>
void carry(Parcel& parcel, Of& draw) {
  parcel(draw.parameters, draw.filter, draw.lagged, draw.slow);
}

/// The baseline: results of learning.
struct Baseline {
  CovariateScaling scaling = {};
  Eigen::VectorXd usual_sds = {};    ///< p, or empty
  Eigen::VectorXd reference = {};    ///< p: medians of the features in learning
  Eigen::VectorXd residual_sd = {};  ///< p: of drift and noise together, posterior mean
  std::vector<BaselineDraw> draws = {};
  double rows_per_hour = 1.0;
  double last_hours = 0.0;  ///< time of the last row that the filters have seen
  // Diagnostics of the engine:
  std::vector<double> hinge_probability = {};  ///< of 0, 1, … hinges
  bool converged = false;
  double rhat_max = 1.0;  ///< over effects of covariates, noise and drift
  long likelihood_evaluations = 0;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Baseline>
void carry(Parcel& parcel, Of& b) {
  parcel(b.scaling, b.usual_sds, b.reference, b.residual_sd, b.draws, b.rows_per_hour, b.last_hours,
         b.hinge_probability, b.converged, b.rhat_max, b.likelihood_evaluations);
}

/// Learns from all rows of `learning`. Throws std::invalid_argument where find_faults names a fault
/// other than a constant covariate.
[[nodiscard]] Baseline learn_baseline(const Series& learning, const LearningOptions& options);

/// Follows the lags of one draw.
[[nodiscard]] Weather next_weather(const CovariateScaling::Scaled& scaled, double hours,
                                   BaselineDraw& draw);

}  // namespace wheeltap::identification::monitoring
