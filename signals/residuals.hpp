// Residual analysis: Gaussian and autoregressive likelihoods, and tests for whiteness.
#pragma once

#include <span>
#include <vector>

namespace wheeltap::signals {

/// Computes the log-likelihood of independent normal residuals, ln ∏ N(r_n | 0, σ²) = -N/2 ln(2π
/// σ²) - S / (2σ²), from S = Σ r_n². The result is -∞ for S = ∞ or σ <= 0.
[[nodiscard]] double gaussian_log_likelihood(double sum_of_squares, int samples, double sigma);

/// Converts partial autocorrelations in (-1, 1) to the coefficients φ of the AR(p) process r_n = Σ
/// φ_j r_{n-j} + ε_n. The conversion is a one-to-one map onto the stationary processes
/// (Barndorff-Nielsen & Schou 1973; Durbin-Levinson recursion). Throws std::invalid_argument for a
/// partial autocorrelation outside (-1, 1).
[[nodiscard]] std::vector<double> ar_coefficients(std::span<const double> partial_autocorrelations);

/// Computes the exact log-likelihood of residuals under a stationary Gaussian AR(p) process.
/// `sigma` is the marginal standard deviation of the process, so that sigma has the same meaning
/// with and without correlation. The likelihood is the product of the densities of the innovations.
/// Given the past residuals, r_n is normal about the Durbin-Levinson predictor of order m = min(n,
/// p), with the variance σ² ∏_{j<=m} (1 - π_j²). N residuals need N p multiplications; p = 0 is
/// white noise. The result is -∞ for sigma <= 0 or a partial autocorrelation outside (-1, 1).
[[nodiscard]] double ar_log_likelihood(std::span<const double> residuals,
                                       std::span<const double> partial_autocorrelations,
                                       double sigma);

/// Computes the standardised innovations of ar_log_likelihood for sigma = 1: e_t / √(∏_{j<=m} (1 -
/// π_j²)). The log-likelihood is then ln p = c(π) - N ln σ - ½ Σ out_t² / σ². The innovations are
/// linear in the residuals. `out` may be the same memory as `residuals`. Throws
/// std::invalid_argument for a partial autocorrelation outside (-1, 1).
void ar_innovations(std::span<const double> residuals,
                    std::span<const double> partial_autocorrelations, std::span<double> out);

/// Computes the sample autocorrelations ρ_1 … ρ_lags of x, ρ_k = Σ (x_n - x̄)(x_{n+k} - x̄) / Σ
/// (x_n - x̄)². Throws std::invalid_argument unless 1 <= lags < x.size().
[[nodiscard]] std::vector<double> autocorrelation(std::span<const double> x, int lags);

/// Estimates the partial autocorrelations π_1 … π_lags of x by Burg's method (1975). Each π_m is
/// the value in [-1, 1] that minimises the sum of squares of the forward and backward prediction
/// errors. For residuals that are nearly as smooth as a response, the magnitudes of the Yule-Walker
/// estimates are far too small. Burg's estimates do not have this bias. If the prediction error is
/// 0 at some lag, π_m = 0 at all later lags.
[[nodiscard]] std::vector<double> burg_partial_autocorrelation(std::span<const double> x, int lags);

/// Selects the order p of an autoregressive model of the residuals by Schwarz's criterion (BIC).
/// The order p <= `most` minimises
///
///   N ln σ² ∏_{m<=p} (1 - π_m²) + p ln N,   π by Burg's method.
///
/// The order is at most a quarter of the number of residuals.
[[nodiscard]] int autoregressive_order(std::span<const double> residuals, int most = 20);

/// Result of a test for whiteness (Ljung & Box 1978). The statistic is Q = N (N + 2) Σ ρ_k² / (N -
/// k). If the residuals are white, Q has a χ² distribution with (lags - fitted) degrees of freedom.
struct Whiteness {
  double statistic = 0.0;
  int degrees_of_freedom = 0;
  double p_value = 1.0;
};

/// Tests residuals for whiteness. `fitted` is the number of AR coefficients that were fitted to
/// these residuals. Throws std::invalid_argument unless fitted < lags < x.size().
[[nodiscard]] Whiteness ljung_box(std::span<const double> residuals, int lags, int fitted = 0);

}  // namespace wheeltap::signals
