#include "identification/sid/base_integration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace wheeltap::identification::base_integration_test {
namespace {

constexpr double kRate = 200.0;
constexpr int kSamples = 2000;

/// A base motion y_b = A sin ωt measured with a sensor offset, and a response of two quantities:
/// the base motion plus an oscillation.
SidCase moving(dynamics::Quantity quantity, double sensor_offset) {
  const double omega = 2.0 * std::numbers::pi * 1.3, own = 2.0 * std::numbers::pi * 4.1;
  SidCase out;
  out.sample_rate_hz = kRate;
  out.end = kSamples;
  out.channels = {
      {.column = "base", .role = SidChannel::Role::base_acceleration},
      {.column = "laser", .role = SidChannel::Role::response, .mass = 1, .quantity = quantity}};
  for (int n = 0; n < kSamples; ++n) {
    const double t = n / kRate;
    out.channels[0].signal.samples.push_back(-0.02 * omega * omega * std::sin(omega * t) +
                                             sensor_offset);
    out.channels[1].signal.samples.push_back(
        quantity == dynamics::Quantity::velocity
            ? 0.02 * omega * std::cos(omega * t) + 0.005 * own * std::cos(own * t)
            : 0.02 * std::sin(omega * t) + 0.005 * std::sin(own * t));
  }
  return out;
}

// Regression: absolute laser velocities with a base acceleration were rejected.
TEST(BaseIntegration, FindsTheBaseMotionForAnySensorOffset) {
  for (const auto quantity : {dynamics::Quantity::velocity, dynamics::Quantity::displacement}) {
    for (const double offset : {0.0, 0.05}) {
      SidCase c = moving(quantity, offset);
      ASSERT_TRUE(needs_integrated_base(c));
      integrate_base(c);
      EXPECT_FALSE(needs_integrated_base(c));
      const SidChannel* base = c.find(SidChannel::Role::base_displacement);
      ASSERT_NE(base, nullptr);
      const auto& y = base->signal.samples;
      ASSERT_EQ(y.size(), static_cast<std::size_t>(kSamples));
      double worst = 0.0;
      for (int n = 1; n + 1 < kSamples; ++n) {
        const double t = n / kRate, omega = 2.0 * std::numbers::pi * 1.3;
        const auto at = static_cast<std::size_t>(n);
        const double velocity = 0.5 * kRate * (y[at + 1] - y[at - 1]);
        worst = std::max(worst, std::abs(velocity - 0.02 * omega * std::cos(omega * t)));
      }
      // The oscillation's trend over 41 periods is about its amplitude divided by 41, less than a
      // twentieth of the base's 0.163 m/s; without the correction 0.05 m/s² give 0.5 m/s.
      EXPECT_LT(worst, 0.008) << offset;
    }
  }
}

TEST(BaseIntegration, IsNotNeededForRelativeMotion) {
  SidCase c = moving(dynamics::Quantity::velocity, 0.0);
  c.channels[1].frame = dynamics::Frame::relative;
  EXPECT_FALSE(needs_integrated_base(c));
}

}  // namespace
}  // namespace wheeltap::identification::base_integration_test
