// Steps must follow the fastest rate of a chain for all laws, and a run with too long steps must
// fail.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "dynamics/simulate.hpp"
#include "tests/dynamics/chains.hpp"

namespace step_choice_test {
namespace {

using namespace wheeltap::dynamics;

std::vector<double> swept(std::size_t samples, double amplitude) {
  std::vector<double> force(samples);
  for (std::size_t n = 0; n < samples; ++n)
    force[n] = amplitude * std::sin(0.6 * static_cast<double>(n));
  return force;
}

Simulator one_mass(const Law& law, double amplitude, SimulatorOptions options = {},
                   double rate = 20.0) {
  const Chain chain{.masses = {1.0},
                    .links = {{.stiffness = 100.0, .damping = 0.2, .laws = {law}}}};
  return Simulator(
      chain, {.sample_rate_hz = rate, .forces = {{.mass = 1, .signal = {swept(100, amplitude)}}}},
      {{.mass = 1}, {.mass = 1, .quantity = Quantity::acceleration}}, {}, std::move(options));
}

double difference(const Response& a, const Response& b) {
  return ((a.values - b.values).colwise().norm().array() / b.values.colwise().norm().array())
      .maxCoeff();
}

// Regression: 97 of these 100 samples were NaN, and the run had not failed. The check was whether 0
// · y is 0, which a compiler may assume.
TEST(Watch, DetectsNaNOfBoucWenWithTooLongSteps) {
  const Law law = make_law<laws::BoucWen>({500.0, 1e-4, 10.0});
  const Response response = one_mass(law, 10.0, {.substeps = 8}).simulate({});
  EXPECT_TRUE(response.failed);
  EXPECT_EQ(response.values.size(), 0);
}

// The same for every integrator, and for a state that is NaN from the start.
TEST(Watch, DetectsNaNInEveryIntegrator) {
  const std::vector<std::vector<Law>> kinds{{},
                                            {make_law<laws::Bilinear>({30.0})},
                                            {make_law<laws::Cubic>({10.0})},
                                            {make_law<laws::Coulomb>({1.0, 0.1})},
                                            {make_law<laws::QuadraticDamping>({1.0})},
                                            {make_law<laws::BoucWen>({50.0, 0.1})}};
  for (int masses : {1, 2, 3, 5})
    for (const std::vector<Law>& laws : kinds)
      for (bool series : {false, true})
        for (bool velocity : {false, true}) {
          Chain chain = uniform_chain(masses);
          chain.links[0].laws = laws;
          InitialState start{.displacement = {}, .velocity = {}};
          start.displacement.assign(static_cast<std::size_t>(masses), 0.0);
          start.velocity = start.displacement;
          (velocity ? start.velocity : start.displacement)[0] = Coefficient::of_parameter(0);
          // One sample: there is no check within the run.
          for (std::size_t samples : {1U, 2U, 100U}) {
            const Simulator simulator(
                chain,
                {.sample_rate_hz = 50.0, .forces = {{.mass = 1, .signal = {noise(samples, 1)}}}},
                displacements(masses), start, {.prefer_series = series});
            const double theta[] = {std::numeric_limits<double>::quiet_NaN()};
            EXPECT_TRUE(simulator.simulate(theta).failed)
                << masses << " masses, " << samples << " samples, velocity " << velocity;
            const double finite[] = {0.01};
            EXPECT_FALSE(simulator.simulate(finite).failed);
          }
        }
}

// Regression: for five laws, the step choice ignored the rate of the internal state; 30 to 40 % of
// the response was wrong.
TEST(StepChoice, CoversBoucWenWithASmallYieldExtension) {
  for (double yield : {1e-1, 1e-2, 1e-3})
    for (double exponent : {1.0, 10.0}) {
      const Law law = make_law<laws::BoucWen>({500.0, yield, exponent});
      const Response fine = one_mass(law, 10.0, {.substeps = 4096}).simulate({});
      const Response chosen = one_mass(law, 10.0).simulate({});
      ASSERT_FALSE(chosen.failed) << yield << ' ' << exponent;
      EXPECT_LT(difference(chosen, fine), 5e-4) << yield << ' ' << exponent;
    }
}

// Drag only dissipates energy. Regression: with steps that ignored it, the trajectory diverged and
// was removed from the prior.
TEST(StepChoice, PassiveDragDoesNotDiverge) {
  for (double drag : {1.0, 30.0, 100.0, 1e3, 1e4}) {
    const Law law = make_law<laws::QuadraticDamping>({drag});
    const Response chosen = one_mass(law, 100.0).simulate({});
    ASSERT_FALSE(chosen.failed) << drag;
    const Response fine = one_mass(law, 100.0, {.step_limit = 0.05}).simulate({});
    ASSERT_FALSE(fine.failed) << drag;
    EXPECT_LT(difference(chosen, fine), 1e-3) << drag;
  }
  // A Misfit, through which priors are truncated, fails in the same cases.
  const Misfit misfit(
      one_mass(make_law<laws::QuadraticDamping>({Coefficient::of_parameter(0)}), 100.0),
      {{noise(100, 3)}, {noise(100, 4)}});
  const std::vector<double> thetas{1e4, 1.0, 1e3};
  std::vector<double> sums(6);
  misfit.sums_of_squares(thetas, 3, sums);
  for (double sum : sums) EXPECT_TRUE(std::isfinite(sum));
}

TEST(StepChoice, DistinguishesTooLongStepsFromDivergence) {
  const auto outcome = [](const Simulator& simulator) { return simulator.simulate({}).outcome; };
  EXPECT_EQ(outcome(one_mass(make_law<laws::Cubic>({1.0}), 10.0)), Outcome::complete);
  // A well of finite depth: the mass leaves it for any step length.
  EXPECT_EQ(outcome(one_mass(make_law<laws::Cubic>({-500.0}), 100.0)), Outcome::diverged);
  // Negative drag.
  EXPECT_EQ(outcome(one_mass(make_law<laws::QuadraticDamping>({-50.0}), 100.0)), Outcome::diverged);
  // 4096 steps per sample are too few, or the given number is.
  EXPECT_EQ(outcome(one_mass(make_law<laws::BoucWen>({500.0, 1e-8}), 10.0)),
            Outcome::steps_too_long);
  EXPECT_EQ(outcome(one_mass(make_law<laws::Coulomb>({1e9, 1e-6}), 10.0)), Outcome::steps_too_long);
  EXPECT_EQ(outcome(one_mass(make_law<laws::BoucWen>({500.0, 1e-4, 10.0}), 10.0, {.substeps = 8})),
            Outcome::steps_too_long);
  const double negative[] = {-1.0};
  EXPECT_EQ(one_mass(make_law<laws::BoucWen>({500.0, Coefficient::of_parameter(0)}), 10.0)
                .simulate(negative)
                .outcome,
            Outcome::impossible);
}

// Regression: if damping chose the steps, refined steps were equally long, and a step check found
// no change.
TEST(StepChoice, RefinedStepsAreShorterIfDampingChoseThem) {
  const Simulator simulator = one_mass(make_law<laws::Coulomb>({2.0, 0.01}), 10.0);
  const int coarse = simulator.substeps({});
  EXPECT_GE(coarse, 8);
  EXPECT_GE(simulator.refined(4).substeps({}), 4 * coarse / 2);
}

// Regression: if one step per sample sufficed at half the limit, refined steps were equally long,
// and a step check found no change.
TEST(StepChoice, RefinedStepsAreShorterIfOnePerSampleWasChosen) {
  const Chain chain{.masses = {1.0}, .links = {{.laws = {make_law<laws::Coulomb>({1e-3, 1.0})}}}};
  const Simulator simulator(
      chain, {.sample_rate_hz = 100.0, .forces = {{.mass = 1, .signal = {noise(50, 1)}}}},
      displacements(1));
  EXPECT_EQ(simulator.substeps({}), 1);
  EXPECT_EQ(simulator.refined(2).substeps({}), 2);
  EXPECT_EQ(simulator.refined(2).refined(4).substeps({}), 8);
}

// Regression: rates were summed in an array of 65 rows.
TEST(StepChoice, HandlesManyMasses) {
  Chain chain = uniform_chain(300);
  chain.masses.back() = 0.05;
  const Rates rates = stiffest_rates(chain, {});
  EXPECT_NEAR(rates.frequency, std::sqrt(100.0 / 0.05), 1e-9);
  EXPECT_NEAR(rates.damping, 0.2 / 0.05, 1e-12);
}

TEST(StepChoice, PacesAreRatesPerUnitOfSpeed) {
  Chain chain = uniform_chain(2);
  chain.masses = {2.0, 4.0};
  chain.links[0].laws = {make_law<laws::QuadraticDamping>({3.0}), make_law<laws::Cubic>({9.0})};
  chain.links[1].laws = {make_law<laws::QuadraticDamping>({-3.0}),
                         make_law<laws::BoucWen>({500.0, 0.01, 3.0})};
  std::vector<double> pace(2);
  paces(chain, {}, pace);
  EXPECT_TRUE(is_paced(chain));
  EXPECT_NEAR(pace[0], 2.0 * 3.0 / 2.0, 1e-12);
  EXPECT_NEAR(pace[1], 2.0 * 3.0 * (1.0 / 2.0 + 1.0 / 4.0) + 3.0 / 0.01, 1e-9);
  EXPECT_FALSE(is_paced(uniform_chain(2)));
}

// β > γ: a fully yielded link is stiffer at a reversal than at rest, by 2 β / (β + γ).
TEST(StepChoice, IncludesTheUnloadingStiffnessOfBoucWen) {
  const Chain chain{.masses = {1.0},
                    .links = {{.laws = {make_law<laws::BoucWen>({50.0, 0.01, 1.0, 0.9, 0.1})}}}};
  EXPECT_NEAR(stiffest_rates(chain, {}).frequency, std::sqrt(90.0), 1e-12);
}

}  // namespace

}  // namespace step_choice_test
