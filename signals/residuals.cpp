#include "signals/residuals.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"

namespace wheeltap::signals {

namespace {

/// Makes one step of the Durbin-Levinson recursion: computes φ of order m from φ of order m - 1, in
/// place.
void extend(std::vector<double>& phi, double partial) {
  const std::size_t m = phi.size();
  for (std::size_t j = 0; j < m / 2; ++j) {
    const double left = phi[j], right = phi[m - 1 - j];
    phi[j] = left - partial * right;
    phi[m - 1 - j] = right - partial * left;
  }
  if (m % 2 == 1) phi[m / 2] *= 1.0 - partial;
  phi.push_back(partial);
}

void require_lags(int lags, int at_least, std::size_t samples) {
  if (lags < at_least || static_cast<std::size_t>(lags) >= samples)
    throw std::invalid_argument("lags = " + std::to_string(lags) + ", must be in [" +
                                std::to_string(at_least) + ", " + std::to_string(samples) + ")");
}

}  // namespace

double gaussian_log_likelihood(double sum_of_squares, int samples, double sigma) {
  if (!(sigma > 0.0) || sum_of_squares == kInfinity) return -kInfinity;
  const double variance = sigma * sigma;
  return -0.5 * (samples * std::log(2.0 * std::numbers::pi * variance) + sum_of_squares / variance);
}

std::vector<double> ar_coefficients(std::span<const double> partial_autocorrelations) {
  std::vector<double> phi;
  for (double partial : partial_autocorrelations) {
    if (!(std::abs(partial) < 1.0))
      throw std::invalid_argument("partial autocorrelation = " + std::to_string(partial) +
                                  ", must be in (-1, 1)");
    extend(phi, partial);
  }
  return phi;
}

double ar_log_likelihood(std::span<const double> residuals,
                         std::span<const double> partial_autocorrelations, double sigma) {
  if (!(sigma > 0.0)) return -kInfinity;
  for (double partial : partial_autocorrelations)
    if (!(std::abs(partial) < 1.0)) return -kInfinity;
  const std::size_t n = residuals.size(), order = partial_autocorrelations.size();
  std::vector<double> phi;
  phi.reserve(order);
  double variance = sigma * sigma, sum = 0.0;
  const auto innovation = [&](std::size_t t) {
    double predicted = 0.0;
    for (std::size_t j = 0; j < phi.size(); ++j) predicted += phi[j] * residuals[t - 1 - j];
    return residuals[t] - predicted;
  };
  double log_variances = 0.0;
  std::size_t t = 0;
  for (; t < std::min(n, order); ++t) {
    const double e = innovation(t);
    sum += e * e / variance;
    log_variances += std::log(variance);
    extend(phi, partial_autocorrelations[t]);
    variance *= 1.0 - partial_autocorrelations[t] * partial_autocorrelations[t];
  }
  double rest = 0.0;
  for (; t < n; ++t) {
    const double e = innovation(t);
    rest += e * e;
  }
  if (n > order) {
    sum += rest / variance;
    log_variances += static_cast<double>(n - order) * std::log(variance);
  }
  return -0.5 * (static_cast<double>(n) * std::log(2.0 * std::numbers::pi) + log_variances + sum);
}

void ar_innovations(std::span<const double> residuals,
                    std::span<const double> partial_autocorrelations, std::span<double> out) {
  const std::size_t n = residuals.size(), order = std::min(partial_autocorrelations.size(), n);
  const auto at = [&](std::span<const double> phi, std::size_t t) {
    double predicted = 0.0;
    for (std::size_t j = 0; j < phi.size(); ++j) predicted += phi[j] * residuals[t - 1 - j];
    return residuals[t] - predicted;
  };
  // The loop runs from the last to the first entry, because each innovation needs earlier
  // residuals.
  const std::vector<double> phi = ar_coefficients(partial_autocorrelations);
  double variance = 1.0;
  for (const double partial : partial_autocorrelations) variance *= 1.0 - partial * partial;
  for (std::size_t t = n; t-- > order;) out[t] = at(phi, t) / std::sqrt(variance);
  for (std::size_t t = order; t-- > 0;) {
    const auto known = partial_autocorrelations.first(t);
    variance = 1.0;
    for (const double partial : known) variance *= 1.0 - partial * partial;
    out[t] = at(ar_coefficients(known), t) / std::sqrt(variance);
  }
}

std::vector<double> autocorrelation(std::span<const double> x, int lags) {
  require_lags(lags, 1, x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  double total = 0.0;
  for (double value : x) total += (value - mean) * (value - mean);
  std::vector<double> rho(static_cast<std::size_t>(lags), 0.0);
  if (total == 0.0) return rho;
  for (std::size_t k = 1; k <= rho.size(); ++k) {
    for (std::size_t n = 0; n + k < x.size(); ++n) rho[k - 1] += (x[n] - mean) * (x[n + k] - mean);
    rho[k - 1] /= total;
  }
  return rho;
}

std::vector<double> burg_partial_autocorrelation(std::span<const double> x, int lags) {
  require_lags(lags, 1, x.size());
  std::vector<double> forward(x.begin(), x.end()), backward = forward, partial;
  for (std::size_t m = 1; m <= static_cast<std::size_t>(lags); ++m) {
    double product = 0.0, squares = 0.0;
    for (std::size_t n = m; n < x.size(); ++n) {
      product += forward[n] * backward[n - 1];
      squares += forward[n] * forward[n] + backward[n - 1] * backward[n - 1];
    }
    const double pi = squares > 0.0 ? 2.0 * product / squares : 0.0;
    partial.push_back(pi);
    for (std::size_t n = x.size() - 1; n >= m; --n) {
      const double f = forward[n], b = backward[n - 1];
      forward[n] = f - pi * b;
      backward[n] = b - pi * f;
    }
  }
  return partial;
}

int autoregressive_order(std::span<const double> residuals, int most) {
  most = std::min(most, static_cast<int>(residuals.size()) / 4);
  if (most < 1) return 0;
  const auto n = static_cast<double>(residuals.size());
  double criterion = 0.0, best = 0.0;
  int order = 0, p = 0;
  for (const double pi : burg_partial_autocorrelation(residuals, most)) {
    ++p;
    if (!(std::abs(pi) < 1.0)) break;
    criterion += n * std::log1p(-pi * pi) + std::log(n);
    if (criterion < best) best = criterion, order = p;
  }
  return order;
}

Whiteness ljung_box(std::span<const double> residuals, int lags, int fitted) {
  if (fitted < 0)
    throw std::invalid_argument("fitted = " + std::to_string(fitted) + ", must be >= 0");
  require_lags(lags, fitted + 1, residuals.size());
  const std::vector<double> rho = autocorrelation(residuals, lags);
  const auto n = static_cast<double>(residuals.size());
  Whiteness result{.degrees_of_freedom = lags - fitted};
  for (std::size_t k = 1; k <= rho.size(); ++k)
    result.statistic += rho[k - 1] * rho[k - 1] / (n - static_cast<double>(k));
  result.statistic *= n * (n + 2.0);
  result.p_value = boost::math::gamma_q(0.5 * static_cast<double>(result.degrees_of_freedom),
                                        0.5 * result.statistic);
  return result;
}

}  // namespace wheeltap::signals
