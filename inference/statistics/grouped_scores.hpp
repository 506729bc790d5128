// The error of an estimate from groups of data that a wrong model does not take for what they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::inference {

/// ln p(D_w | z) of one group about the estimate z*, to second order.
struct GroupScore {
  Eigen::VectorXd score;        ///< g_w = ∇ ln p(D_w | z*)
  Eigen::MatrixXd information;  ///< H_w = -∇² ln p(D_w | z*)
};

/// Of one component of z*.
struct GroupedError {
  double sd = 0.0;                    ///< s
  std::vector<double> studentized{};  ///< (z*_b - z*) / s_b of the resamples, ascending
  int groups = 0;

  /// The p-quantile of what ever more groups would tend to, less z*.
  [[nodiscard]] double quantile(double p) const;
};

struct GroupedErrorOptions {
  std::uint64_t seed = 1;
  int resamples = 2000;
};

/// What more and more groups tend to is the zero of the expected score, whatever the model is
/// (Huber 1967, White 1982). The error of z* about it, with P the prior's information and A = P + Σ
/// H_w, is the jackknife's over groups, by one Newton step each,
///
///   s² = (N-1)/N Σ_w δ_w²,   δ_w = -(A - H_w)⁻¹ g_w,
///
/// which unlike the sandwich A⁻¹ Σ g_w g_wᵀ A⁻¹ (Liang & Zeger 1986) knows that groups that say
/// much have drawn z* to themselves (Bell & McCaffrey 2002); and never less than (A⁻¹)_ii.
///
/// Where a few loud groups decide, scores are skewed, and z* and s fall together when the record
/// happened to have none: Student's interval then lies too low and is too short. Quantiles are
/// therefore the bootstrap-t's (Efron 1981; Hall 1988): N groups drawn with replacement, b, have
///
///   z*_b - z* = (P + Σ_b H_w)⁻¹ (Σ_b g_w - Σ_w g_w),   and an s_b by the formula above;
///
///   P(z∞ - z* < s x) = P((z*_b - z*) / s_b > -x),
///
/// and never nearer to z* than Student's with N - 1 degrees of freedom, since few groups rarely
/// hold the loudest. Empty where A is not positive definite; throws std::invalid_argument for fewer
/// than two groups or sizes that differ.
[[nodiscard]] std::vector<GroupedError> grouped_errors(std::span<const GroupScore> groups,
                                                       const Eigen::MatrixXd& prior_information,
                                                       const GroupedErrorOptions& options = {});

}  // namespace wheeltap::inference
