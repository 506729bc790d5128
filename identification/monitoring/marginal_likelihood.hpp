// The evidence of one feature in the training rows, given the nonlinear parameters, for the model
//
//   y = X b + d + s + e,   e_t ~ N(0, σ²/w_t),   d, s: Ornstein-Uhlenbeck with variances
//   σ² fast_ratio and σ² slow_ratio,   b_k ~ N(0, σ² g_k²),   σ² ~ InverseGamma(a, c).
// A Kalman filter of (d, s) whitens both y and the columns of X, because its gain does not
// depend on the data. The integrals over b and σ² then have a closed form. The cost is O(n
// K²).
#pragma once

#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "identification/monitoring/baseline_filter.hpp"

namespace wheeltap::identification::monitoring {

/// The rows in which one feature was measured.
struct FeatureRows {
  std::vector<int> rows = {};  ///< indices of these rows in the series
  Eigen::VectorXd y;           ///< values of the feature in `rows`
  Eigen::VectorXd precision;   ///< w_t > 0: robust weight divided by relative noise variance
};

struct RegressionPrior {
  Eigen::VectorXd coefficient_scale;  ///< g, K
  double shape = 1.0;                 ///< a
  double scale = 1.0;                 ///< c, in the unit of y²
};

struct ProcessRatios {
  double fast_rate = 0.1;  ///< 1/h
  double fast_ratio = 0.3, slow_ratio = 0.1;
  double slow_hours = kSlowHours;
};

struct MarginalLikelihood {
  double log_density = 0.0;
  Eigen::VectorXd coefficients;     ///< posterior mean of b, K
  double shape = 1.0, scale = 1.0;  ///< parameters of the inverse gamma posterior of σ²
};

/// Computes ln p(y), with all normalising constants, and the posterior. `hours` has the times of
/// all rows, and `terms` (K x all rows) has the vector phi of each row.
[[nodiscard]] MarginalLikelihood marginal_likelihood(const std::vector<double>& hours,
                                                     const Eigen::MatrixXd& terms,
                                                     const FeatureRows& feature,
                                                     const ProcessRatios& process,
                                                     const RegressionPrior& prior);

/// The training rows of all features, prepared for repeated computation of the evidence. Each SIMD
/// lane computes one feature (kernels/evidence_kernel.hpp).
class EvidenceData {
 public:
  /// `hours` has the times of all rows.
  EvidenceData(const std::vector<double>& hours, const std::vector<FeatureRows>& features,
               double slow_hours);

  /// Computes the result of `marginal_likelihood` for every feature, up to rounding errors. `terms`
  /// is K x all rows; `fast_ratios` and `priors` have one entry per feature.
  [[nodiscard]] std::vector<MarginalLikelihood> operator()(
      const Eigen::MatrixXd& terms, double fast_rate, double slow_ratio,
      std::span<const double> fast_ratios, std::span<const RegressionPrior> priors) const;

 private:
  const std::vector<double>& hours_;
  const std::vector<FeatureRows>& features_;
  std::vector<std::vector<double>> values_, variances_;  ///< one entry per group of lanes
  std::vector<double> slow_decay_;
  double slow_hours_;
};

/// One-step innovations at coefficients b, divided by σ; their variance is 1 under the model.
[[nodiscard]] Eigen::VectorXd whitened_residuals(const std::vector<double>& hours,
                                                 const Eigen::MatrixXd& terms,
                                                 const FeatureRows& feature,
                                                 const ProcessRatios& process,
                                                 const Eigen::VectorXd& coefficients);

}  // namespace wheeltap::identification::monitoring
