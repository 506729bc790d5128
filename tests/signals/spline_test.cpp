#include "signals/spline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace {

using wheeltap::signals::natural_spline;
using wheeltap::signals::Spline;

// The acceleration of the base, held to first order and integrated twice, passes through the
// samples.
TEST(Spline, AccelerationIntegratesBackToTheSamples) {
  std::vector<double> y;
  const double h = 0.01;
  for (int n = 0; n < 200; ++n) y.push_back(std::sin(0.3 * n) + 0.2 * std::cos(1.1 * n));
  const Spline s = natural_spline(y, h);
  double position = y[0], velocity = s.first_derivative[0];
  for (std::size_t n = 0; n + 1 < y.size(); ++n) {
    const double a0 = s.second_derivative[n], a1 = s.second_derivative[n + 1];
    position += h * velocity + h * h * (2.0 * a0 + a1) / 6.0;
    velocity += h * (a0 + a1) / 2.0;
    EXPECT_NEAR(position, y[n + 1], 1e-11);
    EXPECT_NEAR(velocity, s.first_derivative[n + 1], 1e-9);
  }
}

// For a sine of angle θ per sample, the second derivative is ω² times the factor in the header.
TEST(Spline, GainOnASine) {
  const double theta = 0.7;
  std::vector<double> y;
  for (int n = 0; n < 201; ++n) y.push_back(std::sin(theta * (n - 100)));
  const Spline s = natural_spline(y, 1.0);
  const double gain = 4.0 * std::pow(std::sin(theta / 2), 2) * 3.0 / (2.0 + std::cos(theta));
  for (std::size_t n = 80; n < 120; ++n) EXPECT_NEAR(s.second_derivative[n], -gain * y[n], 1e-12);
}

TEST(Spline, RejectsMisuse) {
  EXPECT_THROW((void)natural_spline(std::vector<double>{1.0, 2.0}, 1.0), std::invalid_argument);
  EXPECT_THROW((void)natural_spline(std::vector<double>{1.0, 2.0, 3.0}, 0.0),
               std::invalid_argument);
}

}  // namespace
