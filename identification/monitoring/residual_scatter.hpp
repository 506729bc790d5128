// Robust covariance of residuals, and Mahalanobis distances of rows with missing entries.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::identification::monitoring {

/// Median and robust covariance of p columns of n residuals; NaN: missing. Standard deviations are
/// 1.4826 times the median absolute deviations. Correlations are computed from values clipped at
/// three standard deviations, over the rows in which both values are present.
struct Scatter {
  Eigen::VectorXd median, sd;
  Eigen::MatrixXd covariance;
};

[[nodiscard]] Scatter robust_scatter(const Eigen::MatrixXd& residuals);

/// Computes (r - m)' S⁻¹ (r - m) over the entries that are present; NaN if all are missing.
[[nodiscard]] double squared_distance(const Scatter& scatter, const Eigen::VectorXd& residuals);

}  // namespace wheeltap::identification::monitoring
