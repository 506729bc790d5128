// The evidence of one feature's learning rows, given the nonlinear parameters:
//
//   y = X b + d + s + e,   e_t ~ N(0, σ²/w_t),   d, s: Ornstein-Uhlenbeck with variances
//   σ² fast_ratio and σ² slow_ratio,   b_k ~ N(0, σ² g_k²),   σ² ~ InverseGamma(a, c).
//
// A Kalman filter of (d, s) whose gain does not depend on the data whitens y and the columns of X
// alike; b and σ² are then integrated in closed form. Cost: O(n K²).
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

/// One feature's rows that are present.
struct FeatureRows {
  std::vector<int> rows = {};  ///< indices of rows in the series
  Eigen::VectorXd y;           ///< their values
  Eigen::VectorXd precision;   ///< w_t > 0: robust weights over relative noise variances
};

struct RegressionPrior {
  Eigen::VectorXd coefficient_scale;  ///< g, K
  double shape = 1.0;                 ///< a
  double scale = 1.0;                 ///< c, in the unit of y²
};

struct ProcessRatios {
  double fast_rate = 0.1;  ///< 1/h
  double fast_ratio = 0.3, slow_ratio = 0.1;
};

struct MarginalLikelihood {
  double log_density = 0.0;
  Eigen::VectorXd coefficients;     ///< posterior mean of b, K
  double shape = 1.0, scale = 1.0;  ///< of σ²'s inverse gamma posterior
};

/// `hours`: of all rows; `terms`: K x (all rows). ln p(y) with every normaliser, and the posterior.
[[nodiscard]] MarginalLikelihood marginal_likelihood(const std::vector<double>& hours,
                                                     const Eigen::MatrixXd& terms,
                                                     const FeatureRows& feature,
                                                     const ProcessRatios& process,
                                                     const RegressionPrior& prior);

/// One-step innovations over σ at coefficients b: what remains of y, unit variance under the model.
[[nodiscard]] Eigen::VectorXd whitened_residuals(const std::vector<double>& hours,
                                                 const Eigen::MatrixXd& terms,
                                                 const FeatureRows& feature,
                                                 const ProcessRatios& process,
                                                 const Eigen::VectorXd& coefficients);

}  // namespace wheeltap::identification::monitoring
