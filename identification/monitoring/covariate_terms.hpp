// Terms of covariates' effects on features: linear, hinges at unknown knots, thermal lag.
//
//   v_c' = (z_c - v_c) / lag,   z_c = (u_c - mean_c) / sd_c          (z held between rows)
//   phi  = [1, v_1 … v_C, max(0, v_h - knot_h) …, cold, warm, long cold, long warm]
//   u_cold = max over c of (low_c - v_c)+,   u_warm = max over c of (v_c - high_c)+
//
// Each of the last four entries is expanded into kUnseenSegments terms. Each term is the part of u
// in one of the segments between kUnseenKnots. The weighted sum of these terms is piecewise
// linear in u, with one slope per segment. The "long" terms use v with the lag kLongLagHours, for
// example for frozen ground. All these terms are zero in the training period, so training does not
// change the priors of their coefficients. Prediction intervals are wider outside the training
// period, and widen again in each new segment.
#pragma once

#include <concepts>
#include <type_traits>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

inline constexpr double kLargestDeviation = 25.0;
inline constexpr double kLargestJump = 3.0;

/// Standardised values of each covariate's last finite reading, and of its last entry that was
/// used; empty before the first row.
struct LastCovariates {
  Eigen::VectorXd read = {}, used = {};
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, LastCovariates>
void carry(Parcel& parcel, Of& last) {
  parcel(last.read, last.used);
}

/// Scaling and imputation of covariates, from the training period.
class CovariateScaling {
 public:
  CovariateScaling() = default;
  /// `covariates` holds n x c training values; NaN: missing. A constant covariate is not used.
  explicit CovariateScaling(const Eigen::MatrixXd& covariates);

  struct Scaled {
    Eigen::VectorXd z = {};         ///< used covariates, standardised; imputed where missing
    Eigen::MatrixXd variance = {};  ///< variance of z: nonzero only for imputed entries
    bool imputed = false;
  };
  /// An entry more than kLargestDeviation standard deviations from the mean, for example the error
  /// code -999, counts as missing. Missing entries are imputed from the normal distribution with
  /// the mean and covariance of the training period: by their conditional mean and variance, given
  /// the present entries.
  [[nodiscard]] Scaled operator()(const Eigen::VectorXd& covariates) const;
  /// Scales a row of a time series by the rules for a single row. In addition, an entry counts
  /// as missing if two conditions hold: it exceeds the range of the training period by more than a
  /// jump, and it differs by more than a jump from the covariate's last reading and last used
  /// entry. A single wrong reading thus does not determine the effect of weather outside the
  /// training period. A jump is the larger of kLargestJump standard deviations and twice the
  /// largest change between two rows of the training period. If the unused reading is at most
  /// kLargestDeviation standard deviations from the mean, the variance of the imputed value is at
  /// least the squared difference between the reading and the imputed value.
  [[nodiscard]] Scaled operator()(const Eigen::VectorXd& covariates, LastCovariates& last) const;

  [[nodiscard]] int count() const { return static_cast<int>(used_.size()); }
  /// Indices of the covariates that vary, in order.
  [[nodiscard]] const std::vector<int>& used() const { return used_; }
  [[nodiscard]] double mean(int i) const { return mean_[i]; }
  [[nodiscard]] double sd(int i) const { return sd_[i]; }

  template <class Parcel, class Of>
  requires std::same_as<std::remove_const_t<Of>, CovariateScaling>
  friend void carry(Parcel& parcel, Of& scaling) {
    parcel(scaling.used_, scaling.mean_, scaling.sd_, scaling.low_, scaling.high_, scaling.jump_,
           scaling.correlation_);
  }

 private:
  [[nodiscard]] Scaled impute(const Eigen::VectorXd& z) const;

  std::vector<int> used_;
  Eigen::VectorXd mean_, sd_;
  Eigen::VectorXd low_, high_;  ///< smallest and largest standardised value of the training period
  Eigen::VectorXd jump_;
  Eigen::MatrixXd correlation_;
};

inline constexpr double kLongLagHours = 72.0;
inline constexpr int kUnseenSegments = 3;
/// Start of each segment: distance of the covariate from the extreme value of the training period,
/// in standard deviations.
inline constexpr double kUnseenKnots[kUnseenSegments] = {0.0, 1.0, 4.0};
/// Number of terms "cold" to "long warm" at the end of phi
inline constexpr int kUnseenTerms = 4 * kUnseenSegments;

/// The nonlinear parameters of the covariates' terms.
struct CovariateTerms {
  double lag_hours = 0.0;  ///< lag of all covariates; 0: no lag
  /// Covariate of each hinge: index among the used covariates
  std::vector<int> hinge_of = {};
  std::vector<double> knots = {};  ///< value of z at each hinge
  /// Smallest and largest lagged value v of each covariate in the training period
  Eigen::VectorXd low = {}, high = {};
  Eigen::VectorXd long_low = {}, long_high = {};  ///< extremes of v with the long lag

  /// Number of terms in phi for c = `covariates` used covariates: 1 + c + knots, and kUnseenTerms
  /// more if c > 0.
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

/// Updates the lagged values v after `hours` with the covariates at z. Without a lag, v = z.
void follow_lag(const Eigen::VectorXd& z, double hours, double lag_hours, Eigen::VectorXd& v);

/// Computes phi for the covariates v (lagged as in `terms`) and `slow` (lagged by kLongLagHours).
[[nodiscard]] Eigen::VectorXd terms_at(const CovariateTerms& terms, const Eigen::VectorXd& v,
                                       const Eigen::VectorXd& slow);

/// Computes d phi/d v, terms x covariates: the sensitivity of phi to errors of v.
[[nodiscard]] Eigen::MatrixXd term_slopes(const CovariateTerms& terms, const Eigen::VectorXd& v);

}  // namespace wheeltap::identification::monitoring
