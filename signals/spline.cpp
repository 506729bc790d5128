#include "signals/spline.hpp"

#include <stdexcept>
#include <string>

namespace wheeltap::signals {

Spline natural_spline(std::span<const double> y, double h) {
  const std::size_t n = y.size();
  if (n < 3)
    throw std::invalid_argument("spline: " + std::to_string(n) + " samples, must be at least 3");
  if (!(h > 0.0))
    throw std::invalid_argument("spline: spacing = " + std::to_string(h) + ", must be > 0");
  Spline s{std::vector<double>(n), std::vector<double>(n, 0.0)};
  std::vector<double>& m = s.second_derivative;
  // m_{i-1} + 4 m_i + m_{i+1} = 6 (y_{i-1} - 2 y_i + y_{i+1}) / h², m_0 = m_{n-1} = 0.
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double pivot = 4.0 - upper[i - 1];
    upper[i] = 1.0 / pivot;
    m[i] = (6.0 / (h * h) * (y[i - 1] - 2.0 * y[i] + y[i + 1]) - m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 2; i > 0; --i) m[i] -= upper[i] * m[i + 1];
  for (std::size_t i = 0; i + 1 < n; ++i)
    s.first_derivative[i] = (y[i + 1] - y[i]) / h - h / 6.0 * (2.0 * m[i] + m[i + 1]);
  s.first_derivative[n - 1] = (y[n - 1] - y[n - 2]) / h + h / 6.0 * (m[n - 2] + 2.0 * m[n - 1]);
  return s;
}

}  // namespace wheeltap::signals
