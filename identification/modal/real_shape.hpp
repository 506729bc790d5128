// Converts a measured complex mode shape to a real one for comparison with an undamped model.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::identification {

/// A real shape y with largest entry 1: the real part of ψ e^{-iθ}. The angle θ maximises the real
/// part and minimises |Im|²:
///
///   θ = ½ arg Σ ψ_k²,   dy = Re(e^{-iθ} dψ) + dθ Im(e^{-iθ} ψ),   dθ = Im(Σ ψ_k dψ_k / Σ ψ_k²).
///
/// The data determine only the direction ŷ of y. The covariance of ŷ is P C P + s² ŷŷᵀ, with P = I
/// - ŷŷᵀ. C is the covariance of y, and s² is the mean variance in the tangent plane. P removes any
/// effect of the scale that was chosen for ψ.
struct RealShape {
  Eigen::VectorXd values = {};      ///< entries of the shape; the largest entry is ±1
  Eigen::MatrixXd covariance = {};  ///< m × m, positive definite
  double imaginary = 0.0;           ///< relative size of the omitted imaginary part: |Im| / |Re|
  bool correlated = true;           ///< false if `real_shape` set the correlations to 0
};

/// Converts a shape ψ. `covariance` (2m × 2m) is the covariance of the unscaled ψ: first all real
/// parts, then all imaginary parts.
///
/// The covariance is estimated from n = `blocks` blocks of a record (0: the covariance is exact).
/// The inverse of an estimated covariance is too large on average. The covariance is therefore
/// multiplied by (n - 1) / (n - p - 2), p = m - 1 (Hartlap, Simon & Schneider 2007, equation 17).
/// The covariance is also multiplied by 1 + B (p - 1), B = (n - p - 2) / ((n - p - 1)(n - p - 4)),
/// because inaccurate weights increase the variance of estimates (Percival et al. 2014, MNRAS
/// 439:2531). With fewer than 2 p + 3 blocks, only the variances are kept.
///
/// Throws std::invalid_argument for fewer than 2 entries, a zero shape, inconsistent dimensions,
/// and a covariance that is not positive definite on the tangent plane.
[[nodiscard]] RealShape real_shape(const Eigen::VectorXcd& shape, const Eigen::MatrixXd& covariance,
                                   int blocks);

/// The factor by which `real_shape` multiplies the covariance of `numbers` quantities, estimated
/// from `blocks` blocks of a record. The factor is 0 if there are too few blocks to estimate
/// correlations.
[[nodiscard]] double estimated_covariance_factor(int numbers, int blocks);

}  // namespace wheeltap::identification
