// A measured complex mode shape as the real line that an undamped model can explain.
#pragma once

#include "base/eigen.hpp"

namespace wheeltap::identification {

/// The shape ψ e^{-iθ} of largest real part, and its real part y scaled to a largest entry of 1:
///
///   θ = ½ arg Σ ψ_k²,   dy = Re(e^{-iθ} dψ) + dθ Im(e^{-iθ} ψ),   dθ = Im(Σ ψ_k dψ_k / Σ ψ_k²),
///
/// which minimises |Im|². What was measured is y's line: its covariance is that on the tangent
/// plane of the line, P C P + s² ŷŷᵀ with P = I - ŷŷᵀ, s² the mean variance on the plane, whatever
/// scale the complex shape's covariance was stated for.
struct RealShape {
  Eigen::VectorXd values = {};      ///< largest entry ±1
  Eigen::MatrixXd covariance = {};  ///< m × m, positive definite
  double imaginary = 0.0;           ///< |Im| / |Re| of what was turned: what is left out
  bool correlated = true;           ///< false: correlations were dropped, see `real_shape`
};

/// `covariance`: of real parts, then imaginary parts, 2m × 2m, of ψ as it is.
///
/// It is an estimate from `blocks` parts of a record, whose inverse is too large: it is raised by
/// (n - 1) / (n - p - 2), p = m - 1 (Hartlap, Simon & Schneider 2007, equation 17), and by
/// 1 + B (p - 1), B = (n - p - 2) / ((n - p - 1)(n - p - 4)), the scatter that weights which err
/// add to what is estimated from them (Percival et al. 2014, MNRAS 439:2531). Where blocks
/// are fewer than 2 p + 3, the variances alone are kept. 0: exact.
///
/// Throws std::invalid_argument for fewer than 2 entries, a zero shape, sizes that do not fit, and
/// a covariance that is not positive definite on the tangent plane.
[[nodiscard]] RealShape real_shape(const Eigen::VectorXcd& shape, const Eigen::MatrixXd& covariance,
                                   int blocks);

/// The same correction of a covariance of `numbers` quantities from `blocks` parts: its factor, or
/// 0 where there are too few of them for correlations.
[[nodiscard]] double estimated_covariance_factor(int numbers, int blocks);

}  // namespace wheeltap::identification
