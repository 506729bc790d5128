// Planned tests of a structure with unknown coefficients, noise of single modes, and values of
// tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/random.hpp"
#include "fem/structures/mesh.hpp"
#include "identification/planning/engine_check.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "tests/identification/plan_cases.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::VectorXd;

/// The beam of plan_cases.hpp with an unknown Young's modulus.
PlanCase with_unknown_modulus(double sd) {
  PlanCase plan = beam_plan(1);
  StructureModel model{.nominal = fem::as_structure(plan.damage_case.beam)};
  model.parameters = {{"E", inference::Prior(inference::LogNormal{std::log(70e9), sd})}};
  model.setters = {[](AnyStructure& structure, double young) {
    for (fem::Member& member : std::get<fem::Structure>(structure).members)
      for (auto& piece : member.pieces) piece.material.young = young;
  }};
  plan.structure.unknown = std::make_shared<const StructureModel>(std::move(model));
  plan.structure.uniform = true;
  return plan;
}

/// ln ∫ p(y | E, x) p(E) dE of the likelihood of a damage run, by the trapezoidal rule.
double log_marginal(inference::Likelihood& likelihood, const inference::Prior& prior, int model,
                    const std::vector<double>& defect) {
  double most = -kInfinity, sum = 0.0;
  std::vector<double> terms;
  constexpr double kStep = 0.01;
  for (double z = -3.5; z < 3.5; z += kStep) {
    std::vector<double> x = {prior.from_standard_normal(z)};
    x.insert(x.end(), defect.begin(), defect.end());
    terms.push_back(likelihood.log_likelihood(model, x) - 0.5 * z * z);
    most = std::max(most, terms.back());
  }
  for (const double t : terms) sum += std::exp(t - most);
  return most + std::log(sum);
}

// The evidence of a damage includes the integral over the unknown modulus.
TEST(PlannedUnknowns, DataAgreeWithTheMarginalLikelihoodOfADamageRun) {
  const PlanCase plan = with_unknown_modulus(0.03);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const ScenarioSource source(structure, 11);
  PlannedStructure::Solver solver(structure);
  const inference::Prior& prior = plan.structure.unknown->parameters[0].prior;
  for (const TestDesign& design : {TestDesign{.sensors = {1, 3, 6}}, TestDesign{}}) {
    const TestData data(structure, plan.noise, design);
    VectorXd mean(data.size()), measured(data.size());
    TestModes nominal;
    for (std::uint64_t number = 1; number < 12; number += 2) {
      const Scenario scenario = source.draw(number, solver);
      ASSERT_EQ(scenario.defects.size(), 1u);
      ASSERT_GE(scenario.draw, 0);
      const auto problem = make_damage_problem(simulated_case(plan, source, design, scenario), {});
      const auto likelihood = problem->problem.likelihood();
      const std::vector<double> defect = {scenario.defects[0].location,
                                          scenario.defects[0].severity};
      const double gain =
          log_marginal(*likelihood, prior, 1, defect) - log_marginal(*likelihood, prior, 0, {});
      ASSERT_TRUE(solver.predict(scenario.defects, nominal));
      data.mean(nominal, mean);
      data.measured(scenario.modes, scenario.numbers, measured);
      const double by_plan = 0.5 * measured.squaredNorm() - 0.5 * (measured - mean).squaredNorm();
      EXPECT_NEAR(by_plan, gain, 0.4 + 0.06 * std::abs(gain)) << "test " << number;
    }
  }
}

// Tests of the intact structure have whitened data with unit variances, unknown modulus included.
TEST(PlannedUnknowns, TheScatterOfIntactTestsIncludesTheUnknownModulus) {
  const PlanCase plan = with_unknown_modulus(0.03);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const ScenarioSource source(structure, 12);
  PlannedStructure::Solver solver(structure);
  const TestData data(structure, plan.noise, {.sensors = {1, 3, 6}});
  const VectorXd effect = data.unknown_effect(VectorXd::Ones(1));
  VectorXd measured(data.size());
  double squares = 0.0, along = 0.0;
  constexpr int kTests = 2000;
  for (std::uint64_t n = 0; n < kTests; ++n) {
    const Scenario scenario = source.draw(2 * n, solver);
    data.measured(scenario.modes, scenario.numbers, measured);
    squares += measured.squaredNorm() / kTests;
    along += std::pow(measured.dot(effect) / effect.norm(), 2) / kTests;
  }
  // The modulus changes the data by many standard errors; the whitened effect is below 1.
  EXPECT_GT(effect.norm(), 0.99);
  EXPECT_LT(effect.norm(), 1.0);
  // Shapes of three sensors have one direction without scatter per mode, as they have no scale.
  const auto expected = static_cast<double>(data.size() - structure.modes());
  EXPECT_NEAR(squares, expected, 5.0 * std::sqrt(2.0 * expected / kTests) + 0.02 * expected);
  EXPECT_NEAR(along, 1.0, 5.0 * std::sqrt(2.0 / kTests));
}

// With an unknown modulus, two frequencies hold only their ratio.
TEST(PlannedUnknowns, AnUnknownModulusReducesTheInformationOfFrequencies) {
  const auto information = [](PlanCase plan) {
    plan.structure.modes = 2;
    const PlanModel model(plan, {});
    const TestScores scores =
        score_designs(model.source(), model.predictions(), plan.noise, {TestDesign{}},
                      {.scenarios = 2000, .tolerance = 0.05})[0];
    return scores.information.value;
  };
  EXPECT_LT(information(with_unknown_modulus(0.03)), information(beam_plan(1)) - 0.2);
}

TEST(PlannedUnknowns, RefusesAddedMasses) {
  PlanCase plan = with_unknown_modulus(0.03);
  plan.structure.masses = {{"mass", fem::as_structure(plan.damage_case.beam)}};
  EXPECT_THROW(PlannedStructure(plan.damage_case, plan.structure), InvalidInput);
}

TEST(PlannedNoise, ListsHoldOneValuePerMode) {
  TestNoise noise{.cov = 0.5, .shape_sd = 0.4, .reference_seconds = 600.0};
  noise.covs = {0.001, 0.002};
  noise.shape_sds = {0.0003, 0.005};
  EXPECT_EQ(noise.frequency_cov(10.0, 0), 0.001);
  EXPECT_EQ(noise.frequency_cov(10.0, 1), 0.002);
  EXPECT_EQ(noise.frequency_cov(10.0, 4), 0.002);
  EXPECT_EQ(noise.shape_sd_now(0), 0.0003);
  EXPECT_EQ(noise.shape_sd_now(3), 0.005);
  // The data of each mode have its noise.
  PlanCase plan = beam_plan(1);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  plan.noise.shape_sds = {0.01, 0.02};
  PlannedStructure::Solver solver(structure);
  TestModes modes;
  ASSERT_TRUE(solver.predict({{0, 0.3, 0.4}}, modes));
  const TestDesign design{.sensors = {1, 3, 6}};
  const TestData data(structure, plan.noise, design);
  plan.noise.shape_sds = {};
  const TestData equal(structure, plan.noise, design);
  VectorXd one(data.size()), other(data.size());
  data.mean(modes, one);
  equal.mean(modes, other);
  const Eigen::Index n = structure.modes();
  EXPECT_NEAR((one.segment(n, 3) - other.segment(n, 3)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((2.0 * one.segment(n + 3, 3) - other.segment(n + 3, 3)).norm(), 0.0, 1e-9);
}

// Before: the same tests chose the threshold and estimated its cost, so that a test without any
// information had a positive value.
TEST(PlannedValue, ATestWithoutInformationHasNoPositiveValueOnAverage) {
  const std::vector<NormalModel> models = {{{0}, 0.5}, {{1}, 0.5}};
  const TestCosts costs{.inspection = 1.0, .missed = 2.0};
  constexpr int kRepeats = 200, kTests = 100;
  double mean = 0.0, squares = 0.0, errors = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    base::Random random(7, 0, static_cast<std::uint64_t>(repeat), base::Purpose::test);
    std::vector<TestOutcome> outcomes;
    for (int i = 0; i < kTests; ++i)
      outcomes.push_back({.model = i % 2, .log_odds = random.normal()});
    const TestOption option{
        .name = "noise", .sensors = {0}, .scores = summarise(outcomes, models, 0.05)};
    const TestValue value = value_of(option, costs, 0.5);
    mean += value.saving / kRepeats;
    squares += value.saving * value.saving / kRepeats;
    errors += value.mcse * value.mcse / kRepeats;
  }
  const double sd = std::sqrt(squares - mean * mean);
  EXPECT_LT(mean, 3.0 * sd / std::sqrt(kRepeats));
  // The error includes that of the false alarms.
  EXPECT_NEAR(std::sqrt(errors), sd, 0.5 * sd);
}

// Before: P(right place) of the last severity with simulated tests was copied to larger severities.
TEST(PlannedDetection, SimulatesTheLargestSeverities) {
  PlanCase plan = beam_plan(1);
  plan.noise.shape_sd = 0.03;
  const PlanModel model(plan, {});
  const PreparedDesign design =
      prepare(model.structure(), model.predictions(), plan.noise, {.sensors = {1, 3, 6}});
  const auto found = detect_everywhere(model.source(), model.predictions(), design,
                                       {.tests = 100, .threshold = 1.0, .tolerance = 0.02});
  int changes = 0;
  for (const PlaceDetection& place : found) {
    const std::size_t n = place.right.size();
    changes += place.detection[n - 2].value == 1.0 && place.detection[n - 3].value == 1.0 &&
               place.right[n - 1].value != place.right[n - 2].value;
  }
  EXPECT_GT(changes, 2);
}

}  // namespace
}  // namespace wheeltap::identification::planning
