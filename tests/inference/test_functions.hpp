// Functions that are hard to maximise, with known maxima of value 0 (5 for two_modes).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace wheeltap::inference {

/// A curved valley to (1, …, 1).
inline double rosenbrock(std::span<const double> z) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    const double a = z[i + 1] - z[i] * z[i], b = 1.0 - z[i];
    sum += 100.0 * a * a + b * b;
  }
  return -sum;
}

/// A local mode at every point of the unit grid; the highest, 0, at (0.5, …), away from the
/// starting centre.
inline double rastrigin(std::span<const double> z) {
  double sum = 0.0;
  for (const double x : z) {
    const double t = x - 0.5;
    sum += 10.0 + t * t - 10.0 * std::cos(2.0 * std::numbers::pi * t);
  }
  return -sum;
}

/// ln of two narrow normal modes, the second e⁵ times higher.
inline double two_modes(std::span<const double> z) {
  double first = 0.0, second = 0.0;
  for (const double x : z) {
    first += (x + 1.0) * (x + 1.0);
    second += (x - 1.0) * (x - 1.0);
  }
  const double a = -0.5 * first / 0.01, b = 5.0 - 0.5 * second / 0.01;
  return std::max(a, b) + std::log1p(std::exp(-std::fabs(a - b)));
}

}  // namespace wheeltap::inference
