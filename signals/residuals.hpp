// Residual analysis: Gaussian and autoregressive likelihoods, and tests for whiteness.
#pragma once

#include <span>
#include <vector>

namespace wheeltap::signals {

/// ln ∏ N(r_n | 0, σ²) from S = Σ r_n²: -N/2 ln(2π σ²) - S / (2σ²). -∞ for S = ∞ or σ <= 0.
[[nodiscard]] double gaussian_log_likelihood(double sum_of_squares, int samples, double sigma);

/// Converts partial autocorrelations in (-1, 1) to the coefficients φ of the AR(p) process r_n = Σ
/// φ_j r_{n-j} + ε_n. The map is one to one onto the stationary processes (Barndorff-Nielsen &
/// Schou 1973; Durbin-Levinson recursion). Throws std::invalid_argument for a value outside.
[[nodiscard]] std::vector<double> ar_coefficients(std::span<const double> partial_autocorrelations);

/// Exact log-likelihood of residuals under a stationary Gaussian AR(p) process with the marginal
/// standard deviation `sigma`, so that sigma has the same meaning with and without correlation. It
/// is the product of the densities of the innovations: given the past, r_n is normal about the
/// Durbin-Levinson predictor of order m = min(n, p), with the variance σ² ∏_{j<=m} (1 - π_j²). It
/// needs N p multiplications; p = 0 is white noise. -∞ for sigma <= 0 or a partial autocorrelation
/// outside (-1, 1).
[[nodiscard]] double ar_log_likelihood(std::span<const double> residuals,
                                       std::span<const double> partial_autocorrelations,
                                       double sigma);

/// The innovations of that likelihood for sigma = 1: e_t / √(∏_{j<=m} (1 - π_j²)), so that ln p =
/// c(π) - N ln σ - ½ Σ out_t² / σ². Linear in the residuals; in place if `out` is `residuals`.
/// Throws std::invalid_argument for a partial autocorrelation outside (-1, 1).
void ar_innovations(std::span<const double> residuals,
                    std::span<const double> partial_autocorrelations, std::span<double> out);

/// ρ_1 … ρ_lags of x about its mean, ρ_k = Σ (x_n - x̄)(x_{n+k} - x̄) / Σ (x_n - x̄)². Throws
/// std::invalid_argument unless 1 <= lags < x.size().
[[nodiscard]] std::vector<double> autocorrelation(std::span<const double> x, int lags);

/// Sample partial autocorrelations π_1 … π_lags by Burg's method (1975): each π_m is the value in
/// [-1, 1] that minimises the sum of squares of the forward and backward prediction errors. If
/// residuals are nearly as smooth as a response, the magnitudes of the Yule-Walker estimates are
/// far too small; those of Burg's method are not. π_m = 0 at all lags after the prediction error
/// vanishes.
[[nodiscard]] std::vector<double> burg_partial_autocorrelation(std::span<const double> x, int lags);

/// The order p of an autoregressive model of these residuals by Schwarz's criterion (BIC): p <=
/// `most` minimises
///
///   N ln σ² ∏_{m<=p} (1 - π_m²) + p ln N,   π by Burg's method,
///
/// and is at most a quarter of the number of residuals.
[[nodiscard]] int autoregressive_order(std::span<const double> residuals, int most = 20);

/// Ljung & Box (1978): Q = N (N + 2) Σ ρ_k² / (N - k), χ² with lags - fitted degrees of freedom if
/// the residuals are white.
struct Whiteness {
  double statistic = 0.0;
  int degrees_of_freedom = 0;
  double p_value = 1.0;
};

/// `fitted` is the number of AR coefficients fitted to these residuals. Throws
/// std::invalid_argument unless fitted < lags < x.size().
[[nodiscard]] Whiteness ljung_box(std::span<const double> residuals, int lags, int fitted = 0);

}  // namespace wheeltap::signals
