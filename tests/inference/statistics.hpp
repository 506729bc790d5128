// Tests of distributions, with stated false-alarm rates.
#pragma once

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <vector>

namespace wheeltap::inference {

/// p-value of the difference between two samples (Kolmogorov-Smirnov, asymptotic).
inline double two_sample_p_value(std::vector<double> a, std::vector<double> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double largest = 0.0;
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    const double value = std::min(a[i], b[j]);
    while (i < a.size() && a[i] <= value) ++i;
    while (j < b.size() && b[j] <= value) ++j;
    largest = std::max(largest, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                         static_cast<double>(j) / static_cast<double>(b.size())));
  }
  const double n = static_cast<double>(a.size()) * static_cast<double>(b.size()) /
                   static_cast<double>(a.size() + b.size());
  const double t = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * largest;
  double p = 0.0;
  for (int k = 1; k <= 100; ++k) p += (k % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * k * k * t * t);
  return std::clamp(p, 0.0, 1.0);
}

/// Chi-squared p-value of counts against expected ones; cells with fewer than 5 expected are
/// pooled.
inline double counts_p_value(const std::vector<double>& observed,
                             const std::vector<double>& expected) {
  double statistic = 0.0, rest_observed = 0.0, rest_expected = 0.0;
  int cells = 0;
  const auto add = [&](double o, double e) {
    statistic += (o - e) * (o - e) / e;
    ++cells;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5.0) {
      add(observed[i], expected[i]);
    } else {
      rest_observed += observed[i];
      rest_expected += expected[i];
    }
  }
  if (rest_expected > 0.0) add(rest_observed, std::max(rest_expected, 1e-12));
  if (cells < 2) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(cells - 1), statistic));
}

/// Chi-squared p-value for two sets of counts from one distribution.
inline double same_counts_p_value(const std::vector<double>& a, const std::vector<double>& b) {
  double na = 0.0, nb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    na += a[i];
    nb += b[i];
  }
  double statistic = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double sum = a[i] + b[i];
    if (sum < 10.0) continue;
    const double ea = sum * na / (na + nb);
    const double eb = sum * nb / (na + nb);
    statistic += (a[i] - ea) * (a[i] - ea) / ea + (b[i] - eb) * (b[i] - eb) / eb;
    ++cells;
  }
  if (cells < 2) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(cells - 1), statistic));
}

}  // namespace wheeltap::inference
