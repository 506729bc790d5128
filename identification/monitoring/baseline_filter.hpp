// Linear state-space model of the healthy structure's features as functions of weather, with
// heavy-tailed noise, and the model's Kalman filter:
//
//   y_tj = phi(u_t)' b_j + d_tj + s_tj + e_tj,
//   d_t: Ornstein-Uhlenbeck, rate `fast_rate`, covariance diag(fast_sd) C diag(fast_sd),
//   s_t: Ornstein-Uhlenbeck with the time constant `slow_hours`, independent between features,
//   e_tj: Student t with `degrees` degrees of freedom, scale noise_sd_j √(relative variance).
//
// The state of feature j has the coefficients b_j of the covariate terms phi and the fast and slow
// drifts d_j and s_j. The observation vector of every feature is h = [phi, 1, 1]. The filter
// processes the entries of a row in sequence, which is exact for Gaussian noise. For Student t
// noise, the predictive density of an entry is Student t, normalised, with the filter's variance S
// as squared scale. The update multiplies the noise variance of the entry by (nu + v²/S)/(nu + 1),
// the inverse of the mean precision of the scale mixture, given the innovation v.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "identification/monitoring/covariate_terms.hpp"
#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr double kGaussian = std::numeric_limits<double>::infinity();
/// The slow drift's time constant is the length of the training period, but at most this value [h].
inline constexpr double kSlowHours = 90.0 * 24.0;

/// Parameters of one posterior draw, for p features and K terms of phi.
struct BaselineParameters {
  CovariateTerms terms = {};
  double fast_rate = 0.1;  ///< 1/h
  double slow_hours = kSlowHours;
  /// Standard deviations of the logarithms of the p features
  Eigen::VectorXd fast_sd = {}, slow_sd = {}, noise_sd = {};
  Eigen::MatrixXd correlation = {};  ///< correlation matrix of d (p x p)
  /// Degrees of freedom of the noise distribution, Student's t
  double degrees = kGaussian;
  /// Prior of the coefficients b (K x p)
  Eigen::MatrixXd coefficient_mean = {}, coefficient_sd = {};

  [[nodiscard]] int features() const { return static_cast<int>(noise_sd.size()); }
  [[nodiscard]] int block() const { return static_cast<int>(coefficient_sd.rows()) + 2; }
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, BaselineParameters>
void carry(Parcel& parcel, Of& b) {
  parcel(b.terms, b.fast_rate, b.slow_hours, b.fast_sd, b.slow_sd, b.noise_sd, b.correlation,
         b.degrees, b.coefficient_mean, b.coefficient_sd);
}

/// Log density of an innovation v whose squared scale is `s`.
[[nodiscard]] double log_innovation_density(double v, double s, double degrees);

/// The regressors of one row under one parameter draw.
struct Weather {
  Eigen::VectorXd h = {};  ///< block(): [phi, 1, 1]
  /// K x K covariance of phi from imputed covariates; empty if no covariate was imputed.
  Eigen::MatrixXd term_covariance = {};
};

/// The Kalman filter: mean and covariance of its state, and its steps.
class BaselineFilter {
 public:
  BaselineFilter() = default;
  /// Initial state: the prior of b, and the stationary distributions of d and s.
  explicit BaselineFilter(const BaselineParameters& parameters);

  /// Predicts the state after `hours`.
  void predict(const BaselineParameters& parameters, double hours);
  /// Computes P h_j, with P the state covariance and h_j the observation vector of feature j. Call
  /// after predict.
  void observe(int feature, const Eigen::VectorXd& h, Eigen::VectorXd& covariance) const;
  [[nodiscard]] double mean(int feature, const Eigen::VectorXd& h) const;
  /// Variance of h_j' x for the state x, computed from P h_j.
  [[nodiscard]] double variance(int feature, const Eigen::VectorXd& h,
                                const Eigen::VectorXd& covariance) const;
  /// Updates the state with an entry of innovation v; its variance s includes the noise.
  void update(const Eigen::VectorXd& covariance, double v, double s);

  /// Gives the drifts their stationary distribution, without correlation with the coefficients.
  void reset_drift(const BaselineParameters& parameters);

  /// Returns the variance that imputed covariates add to the noise variance of a feature.
  [[nodiscard]] double imputation_variance(int feature, const Weather& weather) const;

  Eigen::VectorXd x;
  Eigen::MatrixXd p;

 private:
  int block_ = 0;
  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, BaselineFilter>
  friend void carry(Parcel& parcel, Of& filter) { parcel(filter.x, filter.p, filter.block_); }
};

/// Predictive mean and sd of a row before its features update the filter, and the log density of
/// the row.
struct RowPrediction {
  Eigen::VectorXd mean, sd;      ///< p; sd includes the noise
  Eigen::VectorXd standardised;  ///< p sequential innovations divided by their scales; NaN: missing
  double log_density = 0.0;
};

/// Predicts a row `hours` after the previous row, computes its density and updates the state.
[[nodiscard]] RowPrediction filter_row(const BaselineParameters& parameters, const Weather& weather,
                                       const Row& row, double hours, BaselineFilter& filter);

/// Noise variance of a feature's entry in a row.
[[nodiscard]] double noise_variance(const BaselineParameters& parameters, const Weather& weather,
                                    const Row& row, const BaselineFilter& filter, int feature);

/// Factor by which `update` multiplies the noise variance (see top of file); 1 if Gaussian.
[[nodiscard]] inline double noise_inflation(double v, double s, double degrees) {
  if (degrees == kGaussian) return 1.0;
  return std::max(1.0, (degrees + v * v / s) / (degrees + 1.0));
}

/// Computes h and the covariance of phi from scaled covariates with lagged values v and `slow`.
[[nodiscard]] Weather weather_at(const CovariateTerms& terms,
                                 const CovariateScaling::Scaled& scaled, const Eigen::VectorXd& v,
                                 const Eigen::VectorXd& slow);

}  // namespace wheeltap::identification::monitoring
