// A law needs one file and its lines in dynamics/laws/list.hpp to get a name, defaults, bounds, a
// step choice and all suitable integrators. This program is dynamics/ compiled with the list and
// toy_law.hpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "dynamics/step_check.hpp"
#include "tests/dynamics/toy_law.hpp"

namespace {

using namespace wheeltap::dynamics;

Simulator released_from(double displacement, const Law& law) {
  return Simulator(
      {.masses = {2.0}, .links = {{.laws = {law}}}},
      {.sample_rate_hz = 20.0, .forces = {{.mass = 1, .signal = {std::vector<double>(200, 0.0)}}}},
      {{.mass = 1},
       {.mass = 1, .quantity = Quantity::velocity},
       {.mass = 1, .quantity = Quantity::acceleration}},
      {.displacement = {displacement}, .velocity = {0.0}});
}

TEST(ToyLaw, IsAvailableByNameWithDefaults) {
  const auto infos = law_infos();
  EXPECT_EQ(std::ranges::count(infos, "toy", &LawInfo::name), 1);
  EXPECT_EQ(static_cast<int>(infos.size()), LawList::kSize);
  EXPECT_EQ(make_law("toy", std::vector<Coefficient>{8.0}).coefficients[1].value, 0.5);
}

TEST(ToyLaw, EnforcesItsBounds) {
  const auto chain = [](Coefficient reach) {
    return Chain{.masses = {1.0}, .links = {{.laws = {make_law<laws::Toy>({8.0, reach})}}}};
  };
  EXPECT_NO_THROW(validate(chain(10.0)));
  EXPECT_THROW(validate(chain(0.0)), std::invalid_argument);
  EXPECT_THROW(validate(chain(10.5)), std::invalid_argument);
  const Law law = make_law<laws::Toy>({8.0, Coefficient::of_parameter(0)});
  const double inside[] = {0.3}, outside[] = {-0.3};
  EXPECT_EQ(released_from(0.1, law).simulate(inside).outcome, Outcome::complete);
  EXPECT_EQ(released_from(0.1, law).simulate(outside).outcome, Outcome::impossible);
}

// Conservation of energy: m ẏ²/2 + k s² (|y|/s - ln(1 + |y|/s)).
TEST(ToyLaw, IsIntegratedWithAutomaticSteps) {
  const Simulator simulator = released_from(1.5, make_law<laws::Toy>({8.0, 0.4}));
  EXPECT_GT(simulator.substeps({}), 0);
  const CheckedResponse checked = checked_response(simulator, {});
  ASSERT_EQ(checked.response.outcome, Outcome::complete);
  const Eigen::MatrixXd& r = checked.response.values;
  const auto energy = [&](Eigen::Index n) {
    const double x = std::abs(r(n, 0)) / 0.4;
    return 0.5 * 2.0 * r(n, 1) * r(n, 1) + 8.0 * 0.16 * (x - std::log1p(x));
  };
  for (Eigen::Index n = 0; n < r.rows(); ++n) {
    EXPECT_NEAR(energy(n), energy(0), 1e-5 * energy(0));
    EXPECT_NEAR(2.0 * r(n, 2), -8.0 * r(n, 0) / (1.0 + std::abs(r(n, 0)) / 0.4), 1e-12);
  }
}

}  // namespace
