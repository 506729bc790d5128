#include "identification/sid/findings/link_paths.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Frame;
using dynamics::Quantity;

// The simulated record of the case, without noise.
SidCase clean(SidCase c) {
  c.truth->noise.assign(c.responses().size(), 0.0);
  return simulated(c);
}

double largest(const std::vector<double>& x) {
  double out = 0.0;
  for (const double v : x) out = std::max(out, std::abs(v));
  return out;
}

// T = k e + c ė + k3 e³ from the balance of forces equals that of the law at every sample.
TEST(LinkPaths, TheTensionIsThatOfTheLaw) {
  const SidCase c = clean(small_sid_case());
  const auto problem = make_sid_problem(c);
  const std::vector<double> theta = {50.0, 1000.0};
  const auto paths = link_paths(*problem, 1, theta);
  ASSERT_EQ(paths.size(), 1U);
  const LinkPath& p = paths[0];
  ASSERT_EQ(p.tension.size(), 200U);
  for (std::size_t n = 0; n < p.tension.size(); ++n) {
    const double e = p.extension[n];
    const double law = 50.0 * e + 0.1 * p.rate[n] + 1000.0 * e * e * e;
    EXPECT_NEAR(p.tension[n], law, 1e-9 * largest(p.tension));
  }
}

// A measured acceleration gives the tension for any laws of the model, here the linear model. The
// simulation used finer steps than the case's noise requires of the model.
TEST(LinkPaths, TheMeasuredTensionDependsOnTheDataOnly) {
  SidCase c = small_sid_case();
  c.channels[1] = {.column = "acceleration [m/s^2]",
                   .role = SidChannel::Role::response,
                   .mass = 1,
                   .quantity = Quantity::acceleration};
  c = clean(c);
  const auto problem = make_sid_problem(c);
  const std::vector<double> theta = {50.0, 1000.0};
  const auto truth = link_paths(*problem, 1, theta).at(0);
  const auto linear = link_paths(*problem, 0, theta).at(0);
  ASSERT_EQ(linear.measured.size(), 200U);
  EXPECT_FALSE(linear.differentiated);
  EXPECT_TRUE(linear.measured_extension.empty());
  double apart = 0.0;
  for (std::size_t n = 0; n < 200; ++n) {
    EXPECT_NEAR(linear.measured[n], truth.tension[n], 1e-4 * largest(truth.tension));
    apart = std::max(apart, std::abs(linear.tension[n] - truth.tension[n]));
  }
  EXPECT_GT(apart, 0.1 * largest(truth.tension));
}

// A chain of two masses; a second link to the ground closes a loop.
TEST(LinkPaths, OmitsLinksThatCloseALoop) {
  SidCase c = small_sid_case();
  for (SidModel& model : c.models) {
    model.chain.masses.push_back(1.0);
    model.chain.links.push_back({.a = 1, .b = 2, .stiffness = 80.0});
  }
  const std::vector<double> theta = {50.0, 1000.0};
  const auto problem = make_sid_problem(clean(c));
  const auto paths = link_paths(*problem, 1, theta);
  ASSERT_EQ(paths.size(), 2U);
  for (std::size_t n = 0; n < paths[1].tension.size(); ++n) {
    EXPECT_NEAR(paths[1].tension[n], 80.0 * paths[1].extension[n],
                1e-9 * largest(paths[1].tension));
  }
  for (SidModel& model : c.models) {
    model.chain.links.push_back({.a = 0, .b = 2, .stiffness = 30.0});
  }
  EXPECT_TRUE(link_paths(*make_sid_problem(clean(c)), 1, theta).empty());
}

// A displacement with little noise is differentiated; one with much noise is not.
TEST(LinkPaths, DifferentiatesOnlyWithLittleNoise) {
  SidCase c = small_sid_case();
  c.truth->excitations = {{.mass = 1, .signal = TrueExcitation::Sine{10.0, 1.0, 0.0}}};
  const auto with_noise = [&](double sd) {
    SidCase noisy = c;
    noisy.truth->noise = {sd};
    return link_paths(*make_sid_problem(simulated(noisy)), 1, std::vector{50.0, 1000.0}).at(0);
  };
  const LinkPath quiet = with_noise(1e-6);
  ASSERT_EQ(quiet.measured.size(), 200U);
  EXPECT_TRUE(quiet.differentiated);
  EXPECT_TRUE(std::isnan(quiet.measured[3]));
  ASSERT_EQ(quiet.measured_extension.size(), 200U);
  for (std::size_t n = 4; n < 196; ++n) {
    EXPECT_NEAR(quiet.measured[n], quiet.tension[n], 0.03 * largest(quiet.tension)) << n;
  }
  EXPECT_TRUE(with_noise(0.05).measured.empty());
}

}  // namespace
}  // namespace wheeltap::identification
