// Effects of covariates on features: linear terms, hinges at unknown knots, thermal lag.
//
//   v_c' = (z_c - v_c) / lag,   z_c = (u_c - mean_c) / sd_c          (z held between rows)
//   phi  = [1, v_1 … v_C, max(0, v_h - knot_h) …, cold, warm, long cold, long warm]
//   cold = max over c of (low_c - v_c)+,   warm = max over c of (v_c - high_c)+
//
// The last four terms are zero in the training period. The terms "long" use v with the lag
// kLongLagHours, for example for frozen ground. Training does not change the priors of their
// coefficients, so that predictions are wider in weather outside the training period.
#pragma once

#include <concepts>
#include <type_traits>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr double kLargestDeviation = 25.0;

/// Scaling and imputation of covariates, from the training period.
class CovariateScaling {
 public:
  CovariateScaling() = default;
  /// `covariates`: n x c training rows, NaN: missing. Constant covariates are not used.
  explicit CovariateScaling(const Eigen::MatrixXd& covariates);

  struct Scaled {
    Eigen::VectorXd z = {};         ///< used covariates, standardised; imputed where missing
    Eigen::MatrixXd variance = {};  ///< variance of z: nonzero only for imputed entries
    bool imputed = false;
  };
  /// An entry more than kLargestDeviation standard deviations from the mean, for example the error
  /// code -999, counts as missing. A missing entry gets its conditional mean and variance, given
  /// the present entries, from the normal distribution with mean and covariance of the training
  /// period.
  [[nodiscard]] Scaled operator()(const Eigen::VectorXd& covariates) const;

  [[nodiscard]] int count() const { return static_cast<int>(used_.size()); }
  /// Indices of the covariates that vary, in order.
  [[nodiscard]] const std::vector<int>& used() const { return used_; }
  [[nodiscard]] double mean(int i) const { return mean_[i]; }
  [[nodiscard]] double sd(int i) const { return sd_[i]; }

  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, CovariateScaling>
  friend void carry(Parcel& parcel, Of& scaling) {
    parcel(scaling.used_, scaling.mean_, scaling.sd_, scaling.correlation_);
  }

 private:
  std::vector<int> used_;
  Eigen::VectorXd mean_, sd_;
  Eigen::MatrixXd correlation_;
};

inline constexpr double kLongLagHours = 72.0;
inline constexpr int kUnseenTerms = 4;  ///< number of terms "cold" to "long warm" at the end of phi

/// The nonlinear parameters of the covariates' terms.
struct CovariateTerms {
  double lag_hours = 0.0;  ///< shared by all covariates; 0: none
  /// Covariate of each hinge: index among the used covariates
  std::vector<int> hinge_of = {};
  std::vector<double> knots = {};  ///< values of z, one per hinge
  /// C: smallest and largest v in the training period
  Eigen::VectorXd low = {}, high = {};
  Eigen::VectorXd long_low = {}, long_high = {};  ///< c: the same for v with the long lag

  /// Number of terms in phi for c = `covariates` used covariates: 1 + c + hinges + kUnseenTerms.
  [[nodiscard]] int size(int covariates) const {
    return 1 + covariates + static_cast<int>(knots.size()) + (covariates > 0 ? kUnseenTerms : 0);
  }
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, CovariateTerms>
void carry(Parcel& parcel, Of& terms) {
  parcel(terms.lag_hours, terms.hinge_of, terms.knots, terms.low, terms.high, terms.long_low,
         terms.long_high);
}

/// Updates v after `hours` with the covariate at z. Without a lag, v = z.
void follow_lag(const Eigen::VectorXd& z, double hours, double lag_hours, Eigen::VectorXd& v);

/// phi for the covariates v, lagged as in `terms`, and `slow`, lagged by kLongLagHours.
[[nodiscard]] Eigen::VectorXd terms_at(const CovariateTerms& terms, const Eigen::VectorXd& v,
                                       const Eigen::VectorXd& slow);

/// d phi/d v, (terms) x (covariates): the sensitivity of phi to errors of v.
[[nodiscard]] Eigen::MatrixXd term_slopes(const CovariateTerms& terms, const Eigen::VectorXd& v);

}  // namespace wheeltap::identification::monitoring
