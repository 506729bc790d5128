// The standard normal distribution function and its inverse, accurate in both tails.
#pragma once

namespace wheeltap::inference {

/// ln √(2π).
inline constexpr double kLogSqrt2Pi = 0.91893853320467274178;

/// Φ(z), with full relative accuracy in the lower tail. Φ(z) underflows to 0 below z = -38.5. For
/// the upper tail, use Φ(-z) = 1 - Φ(z).
[[nodiscard]] double normal_cdf(double z);

/// Φ⁻¹(p) for p in [0, 1]; ±∞ at the bounds, NaN outside. Relative error about 1e-16 (Wichura 1988,
/// Applied Statistics 37:477, algorithm AS 241). For p near 1, use -Φ⁻¹(1 - p).
[[nodiscard]] double normal_quantile(double p);

/// Φ⁻¹(½ + q) for |q| <= ½, accurate for small q.
[[nodiscard]] double normal_quantile_from_centre(double q);

/// ln Φ(z) for any z, even if Φ underflows.
[[nodiscard]] double log_normal_cdf(double z);

/// Φ⁻¹(e^lp) for lp <= 0, even if e^lp underflows; NaN for lp > 0.
[[nodiscard]] double normal_quantile_of_log(double lp);

/// ln(e^a + e^b) and ln(e^a - e^b), a >= b, without overflow.
[[nodiscard]] double log_sum_exp(double a, double b);
[[nodiscard]] double log_diff_exp(double a, double b);

}  // namespace wheeltap::inference
