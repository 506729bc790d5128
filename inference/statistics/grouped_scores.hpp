// Standard errors of an estimate from grouped data, which remain valid if the statistical model is
// wrong.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::inference {

/// Second-order approximation of ln p(D_w | z) of one group w about the estimate z*.
struct GroupScore {
  Eigen::VectorXd score;        ///< g_w = ∇ ln p(D_w | z*)
  Eigen::MatrixXd information;  ///< H_w = -∇² ln p(D_w | z*)
};

/// Standard error of one component of z*.
struct GroupedError {
  double sd = 0.0;                    ///< standard error s
  std::vector<double> studentized{};  ///< (z*_b - z*) / s_b of the resamples, ascending
  int groups = 0;

  /// The p-quantile of z∞ - z*, where z∞ is the estimate from infinitely many groups.
  [[nodiscard]] double quantile(double p) const;
};

struct GroupedErrorOptions {
  std::uint64_t seed = 1;
  int resamples = 2000;
};

/// As the number of groups increases, the estimate z* converges to a limit, the point of zero
/// expected score, even for a wrong model (Huber 1967, White 1982). The standard error s of z*, as
/// an estimate of this limit, is computed by the jackknife over groups, with one Newton step for
/// each group. With P the information of the prior and A = P + Σ H_w,
///
///   s² = (N-1)/N Σ_w δ_w²,   δ_w = -(A - H_w)⁻¹ g_w,
///
/// and at least (A⁻¹)_ii. Unlike the sandwich estimate A⁻¹ Σ g_w g_wᵀ A⁻¹ (Liang & Zeger 1986),
/// this estimate corrects for influential groups, which shift z* towards their own estimates (Bell
/// & McCaffrey 2002).
///
/// If a few influential groups dominate, the distribution of scores is skewed. If, by chance,
/// the record contains no influential group, z* and s are both too small. The limits of the
/// confidence interval from Student's t are then too low, and the interval is too narrow. Quantiles
/// are therefore computed by the bootstrap-t (Efron 1981; Hall 1988). A resample b of N groups,
/// drawn with replacement, has
///
///   z*_b - z* = (P + Σ_b H_w)⁻¹ (Σ_b g_w - Σ_w g_w),
///
/// and its s_b follows from the formula above. The quantiles follow from
///
///   P(z∞ - z* < s x) = P((z*_b - z*) / s_b > -x).
///
/// The quantiles are at least as far from z* as the quantiles of Student's t with N - 1 degrees of
/// freedom, because a small number of groups rarely includes the most influential groups. The
/// result is empty if A is not positive definite. Throws std::invalid_argument for fewer than two
/// groups or inconsistent sizes of scores and matrices.
[[nodiscard]] std::vector<GroupedError> grouped_errors(std::span<const GroupScore> groups,
                                                       const Eigen::MatrixXd& prior_information,
                                                       const GroupedErrorOptions& options = {});

}  // namespace wheeltap::inference
