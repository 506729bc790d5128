#include "dynamics/law_cycle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace wheeltap::dynamics {
namespace {

/// The energy dissipated in a cycle, ∮ T de by the trapezoidal rule.
double dissipated(const std::vector<CyclePoint>& points) {
  double energy = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    energy += 0.5 * (points[i].tension + points[i - 1].tension) *
              (points[i].extension - points[i - 1].extension);
  }
  return energy;
}

// Dry friction dissipates 4 F A per cycle; a spring, one-sided or not, dissipates nothing.
TEST(LawCycle, FrictionDissipatesAndSpringsDoNot) {
  const Cycle cycle{.amplitude = 0.01, .period = 0.5, .points = 2001};
  EXPECT_NEAR(dissipated(law_cycle(make_law<laws::Coulomb>({3.0}), cycle)), 4 * 3.0 * 0.01, 2e-4);
  for (const Side side : {Side::opening, Side::closing}) {
    EXPECT_NEAR(dissipated(law_cycle(make_law<laws::Contact>({1e4, 0.004}, side), cycle)), 0, 1e-9);
  }
  EXPECT_NEAR(dissipated(law_cycle(make_law<laws::Cubic>({1e7}), cycle)), 0.0, 1e-9);
}

// ∮ c₂ ė² |ė| dt = 8/3 c₂ A³ ω².
TEST(LawCycle, DragDissipatesItsClosedFormEnergy) {
  const Cycle cycle{.amplitude = 0.01, .period = 0.5, .points = 2001};
  const double omega = 2.0 * M_PI / cycle.period,
               expected = 8.0 / 3.0 * 60.0 * 1e-6 * omega * omega;
  EXPECT_NEAR(dissipated(law_cycle(make_law<laws::QuadraticDamping>({60.0}), cycle)) / expected,
              1.0, 1e-4);
}

// A stop to the left is the mirror image of one to the right.
TEST(LawCycle, ClosingMirrorsOpening) {
  const auto extremes = [](Side side) {
    const auto points = law_cycle(make_law<laws::Contact>({1e4, 0.004}, side), {});
    const auto [low, high] = std::ranges::minmax(points, {}, &CyclePoint::tension);
    return std::pair(low.tension, high.tension);
  };
  EXPECT_EQ(extremes(Side::opening).first, 0.0);
  EXPECT_NEAR(extremes(Side::opening).second, 60.0, 0.01);
  EXPECT_NEAR(extremes(Side::closing).first, -60.0, 0.01);
  EXPECT_EQ(extremes(Side::closing).second, 0.0);
}

// Far beyond yield, a Bouc-Wen law is at its plateau k e_y; in the steady cycle with beta = gamma,
// it unloads with the stiffness before yield.
TEST(LawCycle, HysteresisReachesItsPlateauAndUnloadsElastically) {
  const Cycle cycle{.amplitude = 0.02, .points = 4001};
  const auto points = law_cycle(make_law<laws::BoucWen>({2000.0, 0.002}), cycle);
  const auto top = std::ranges::max_element(points, {}, &CyclePoint::tension);
  EXPECT_NEAR(top->tension, 4.0, 1e-3);
  const auto later = top + 200;  // during unloading
  EXPECT_NEAR((later->tension - top->tension) / (later->extension - top->extension), 2000.0, 10.0);
}

}  // namespace
}  // namespace wheeltap::dynamics
