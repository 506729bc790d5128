#include "dynamics/linear_modes.hpp"
#include "base/constants.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wheeltap::dynamics {
namespace {

TEST(LinearModes, MatchTheFrequencyAndDampingRatioOfOneMass) {
  Chain chain{.masses = {0.5}, .links = {{.a = 0, .b = 1, .stiffness = 50.0, .damping = 0.1}}};
  const auto modes = linear_modes(chain, {});
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_NEAR(modes[0].frequency_hz, 10.0 / (2.0 * kPi), 1e-12);
  EXPECT_NEAR(modes[0].damping_ratio, 0.1 / (2.0 * std::sqrt(0.5 * 50.0)), 1e-12);
  chain.links[0].damping = 20.0;  // overdamped: 2 √(k m) is 10
  EXPECT_TRUE(linear_modes(chain, {}).empty());
  chain.links[0].damping = 0.1;
  chain.links[0].stiffness = -50.0;
  EXPECT_TRUE(linear_modes(chain, {}).empty()) << "a double well does not oscillate about its top";
}

// A fixed-free chain of n equal masses: ω_j = 2 √(k/m) sin((2j - 1) π / (4n + 2)); with C = (c/k)
// K, ζ_j = c ω_j / 2k.
TEST(LinearModes, MatchTheClosedFormForAnEqualChain) {
  for (const double unit : {1.0, 1e9}) {
    Chain chain;
    const int n = 5;
    const double k = 300.0 * unit, m = 2.0, c = 0.4 * unit / std::sqrt(unit);
    for (int i = 0; i < n; ++i) {
      chain.masses.emplace_back(m);
      chain.links.push_back({.a = i, .b = i + 1, .stiffness = k, .damping = c});
    }
    const auto modes = linear_modes(chain, {});
    ASSERT_EQ(modes.size(), 5U);
    for (int j = 1; j <= n; ++j) {
      const double omega = 2.0 * std::sqrt(k / m) * std::sin((2 * j - 1) * kPi / (4 * n + 2));
      const LinearMode& mode = modes[static_cast<std::size_t>(j - 1)];
      EXPECT_NEAR(mode.frequency_hz / (omega / (2.0 * kPi)), 1.0, 1e-11);
      EXPECT_NEAR(mode.damping_ratio / (c * omega / (2.0 * k)), 1.0, 1e-9);
    }
  }
}

TEST(LinearModes, OmitTheRigidMotion) {
  const Chain free{
      .masses = {1.0, 1.0, 1.0},
      .links = {{.a = 1, .b = 2, .stiffness = 10.0}, {.a = 2, .b = 3, .stiffness = 10.0}}};
  const auto modes = linear_modes(free, {});
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_NEAR(modes[0].frequency_hz, std::sqrt(10.0) / (2.0 * kPi), 1e-12);
  EXPECT_NEAR(modes[1].frequency_hz, std::sqrt(30.0) / (2.0 * kPi), 1e-12);
  EXPECT_NEAR(modes[0].damping_ratio, 0.0, 1e-12);
}

}  // namespace
}  // namespace wheeltap::dynamics
