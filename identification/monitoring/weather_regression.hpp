// Removal of the covariates' effect from features for control charts: least squares on linear terms
// and hinges, and Gaussian process regression.
#pragma once

#include <vector>

#include "identification/monitoring/covariate_terms.hpp"
#include "identification/monitoring/series.hpp"

namespace wheeltap::identification::monitoring {

/// y_j = b_j0 + Σ_c b_jc z_c + Σ_h b_jh max(0, z_h - κ_h), by least squares with robust weights.
/// Each covariate has a hinge at its median. A covariate whose training values have both signs also
/// has a hinge at zero, because slopes of features often change at 0 °C.
class HingeRegression {
 public:
  explicit HingeRegression(const Series& learning);
  /// The p residuals of a row; NaN for a missing entry.
  [[nodiscard]] Eigen::VectorXd residuals(const Row& row) const;

 private:
  [[nodiscard]] Eigen::VectorXd terms(const Eigen::VectorXd& covariates) const;
  CovariateScaling scaling_;
  std::vector<int> hinge_of_;
  std::vector<double> knots_;
  Eigen::MatrixXd coefficients_;  // terms x p
};

/// A Gaussian process for each feature, as a function of the c standardised covariates:
///
///   k(z, z') = exp(-|z - z'|²/(2 c ℓ²)) + 0.1 z'z'/c + ρ δ,
///
/// scaled by σ². ℓ and ρ maximise the marginal likelihood on a grid; σ² has a closed form
/// (Rasmussen & Williams 2006, equation 5.8). If the training period has more than kMostPoints
/// rows, kMostPoints evenly spaced rows are used.
class ProcessRegression {
 public:
  static constexpr int kMostPoints = 300;
  explicit ProcessRegression(const Series& learning);
  /// The p residuals of a row, divided by their predictive standard deviations; NaN: missing.
  [[nodiscard]] Eigen::VectorXd residuals(const Row& row) const;

 private:
  struct Feature {
    Eigen::MatrixXd points = {};   // covariates x n
    Eigen::MatrixXd inverse = {};  // inverse kernel matrix (n x n)
    Eigen::VectorXd weights = {};  // `inverse` times the n values of the feature
    double mean = 0.0, length = 1.0, noise = 0.1, variance = 1.0;
  };
  [[nodiscard]] static Feature fit(const Eigen::MatrixXd& points, const Eigen::VectorXd& values);
  CovariateScaling scaling_;
  std::vector<Feature> features_;
};

}  // namespace wheeltap::identification::monitoring
