// Evidences, probability of detection and expected information of planned tests against quadrature.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

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

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Two places with effects p Δ_a, p ~ U(0, 1), two models, normal data in the plane.
NormalTest two_places() {
  MatrixXd a(2, 2), b(2, 2);
  a << 0.0, 3.5, 0.0, 1.0;
  b << 0.0, 1.0, 0.0, -2.5;
  return NormalTest({{.kind = 0, .prior = 0.7, .nodes = a}, {.kind = 0, .prior = 0.3, .nodes = b}},
                    {{{0}, 0.6}, {{1}, 0.4}});
}

/// By quadrature in the plane of the data, with p(y | place) by the midpoint rule in p.
struct Exact {
  double detection, information;
};
Exact by_quadrature(double false_alarm) {
  const double step = 0.02, low = -6.0, high = 9.0;
  const VectorXd a = Eigen::Vector2d(3.5, 1.0), b = Eigen::Vector2d(1.0, -2.5);
  struct Point {
    double odds, intact, damaged;
  };
  std::vector<Point> points;
  double information = 0.0;
  const double area = step * step;
  const auto normal = [](double x, double y) { return std::exp(-0.5 * (x * x + y * y)) / kTwoPi; };
  for (double x = low; x < high; x += step)
    for (double y = low; y < high; y += step) {
      double pa = 0.0, pb = 0.0;
      constexpr int kSteps = 48;
      for (int i = 0; i < kSteps; ++i) {
        const double p = (i + 0.5) / kSteps;
        pa += normal(x - p * a[0], y - p * a[1]) / kSteps;
        pb += normal(x - p * b[0], y - p * b[1]) / kSteps;
      }
      const double p0 = normal(x, y), p1 = 0.7 * pa + 0.3 * pb, all = 0.6 * p0 + 0.4 * p1;
      if (!(all > 0.0)) continue;
      const auto term = [&](double prior, double p) {
        return p > 0.0 ? prior * p * std::log(p / all) * area : 0.0;
      };
      information += term(0.6, p0) + term(0.4 * 0.7, pa) + term(0.4 * 0.3, pb);
      points.push_back({p1 / std::max(p0, 1e-300), p0 * area, p1 * area});
    }
  std::ranges::sort(points, [](const Point& p, const Point& q) { return p.odds > q.odds; });
  double alarms = 0.0, detected = 0.0;
  for (const Point& p : points) {
    if (alarms + p.intact > false_alarm) break;
    alarms += p.intact;
    detected += p.damaged;
  }
  return {detected, information};
}

TestScores simulated(const NormalTest& test, int count, double false_alarm, std::uint64_t seed) {
  const TestScorer scorer(test, {{0, 0.0, 1.0}, {0, 1.0, 2.0}}, 0.5);
  std::vector<TestOutcome> outcomes;
  NormalTest::Answer answer;
  for (int n = 0; n < count; ++n) {
    base::Random random(seed, 0, static_cast<std::uint64_t>(n), base::Purpose::test);
    TestTruth truth{.model = n % 2};
    VectorXd y = Eigen::Vector2d(random.normal(), random.normal());
    if (truth.model == 1) {
      const int place = random.uniform() < 0.7 ? 0 : 1;
      truth.defects.push_back({place, place + 0.5, 0.0});
      y += random.uniform() * test.places()[index(place)].nodes.col(1);
    }
    const MatrixXd products = test.products(y);
    test.answer({y.data(), products.data()}, answer);
    outcomes.push_back(scorer.score(truth, {y.data(), products.data()}, answer));
  }
  return summarise(outcomes, test.models(), false_alarm);
}

TEST(PlannedTest, DetectionAndInformationEqualQuadrature) {
  const Exact exact = by_quadrature(0.05);
  const NormalTest test = two_places();
  // With 10^5 scenarios, within three reported standard errors.
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const TestScores found = simulated(test, 100'000, 0.05, seed);
    EXPECT_NEAR(found.detection.value, exact.detection, 3.0 * found.detection.mcse);
    EXPECT_NEAR(found.information.value, exact.information, 3.0 * found.information.mcse);
    EXPECT_LT(found.detection.mcse, 0.006);
    EXPECT_LT(found.information.mcse, 0.003);
  }
}

// With 6 million scenarios: the estimates have no bias beyond 1e-3.
TEST(PlannedTestStudy, DetectionAndInformationEqualQuadratureToOneThousandth) {
  const Exact exact = by_quadrature(0.05);
  const TestScores many = simulated(two_places(), 6'000'000, 0.05, 4);
  EXPECT_NEAR(many.detection.value, exact.detection, 1e-3);
  EXPECT_NEAR(many.information.value, exact.information, 1e-3);
}

TEST(PlannedTest, PlaceEvidenceIsTheIntegralOverSeverity) {
  std::mt19937 rng(5);
  std::normal_distribution<double> normal;
  for (const double size : {0.01, 1.0, 8.0, 60.0}) {
    // A curve with three segments.
    MatrixXd nodes = MatrixXd::Zero(4, 4);
    for (int i = 1; i < 4; ++i)
      for (int d = 0; d < 4; ++d) nodes(d, i) = nodes(d, i - 1) + size * (0.5 + 0.3 * normal(rng));
    const NormalTest test({{.kind = 0, .prior = 1.0, .nodes = nodes}}, {{{0}, 0.5}, {{1}, 0.5}});
    for (int repeat = 0; repeat < 20; ++repeat) {
      VectorXd y = nodes.col(1) * 1.3 * (repeat % 3) / 2.0;
      for (double& v : y) v += normal(rng);
      const MatrixXd products = test.products(y);
      NormalTest::Answer answer;
      test.answer({y.data(), products.data()}, answer);
      double most = -kInfinity, sum = 0.0;
      constexpr int kSteps = 60'000;
      std::vector<double> terms;
      for (int i = 0; i < kSteps; ++i) {
        const double p = 3.0 * (i + 0.5) / kSteps;
        const int s = std::min(2, static_cast<int>(p));
        const VectorXd at = nodes.col(s) + (p - s) * (nodes.col(s + 1) - nodes.col(s));
        terms.push_back(-0.5 * (y - at).squaredNorm() + 0.5 * y.squaredNorm());
        most = std::max(most, terms.back());
      }
      for (const double t : terms) sum += std::exp(t - most) / kSteps;
      EXPECT_NEAR(answer.log_places[0], most + std::log(sum), 1e-5 * std::max(1.0, std::abs(most)))
          << "size " << size;
    }
  }
}

TEST(PlannedTest, PairEvidenceIsTheIntegralOverBothSeverities) {
  std::mt19937 rng(6);
  std::normal_distribution<double> normal;
  for (const double size : {0.3, 2.0, 10.0}) {
    MatrixXd a = MatrixXd::Zero(5, 2), b = MatrixXd::Zero(5, 2);
    for (int d = 0; d < 5; ++d) {
      a(d, 1) = size * normal(rng);
      b(d, 1) = 0.6 * a(d, 1) + size * normal(rng);
    }
    const NormalTest test(
        {{.kind = 0, .prior = 0.5, .nodes = a}, {.kind = 0, .prior = 0.5, .nodes = b}},
        {{{0}, 0.4}, {{1}, 0.3}, {{2}, 0.3}});
    for (int repeat = 0; repeat < 20; ++repeat) {
      VectorXd y = 0.4 * (repeat % 3) * a.col(1) + 0.3 * (repeat % 2) * b.col(1);
      for (double& v : y) v += normal(rng);
      const MatrixXd products = test.products(y);
      double most = -kInfinity, sum = 0.0;
      constexpr int kSteps = 700;
      std::vector<double> terms;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const double p = (i + 0.5) / kSteps, q = (j + 0.5) / kSteps;
          terms.push_back(-0.5 * (y - p * a.col(1) - q * b.col(1)).squaredNorm() +
                          0.5 * y.squaredNorm());
          most = std::max(most, terms.back());
        }
      for (const double t : terms) sum += std::exp(t - most) / (kSteps * kSteps);
      EXPECT_NEAR(test.log_pair({y.data(), products.data()}, 0, 1), most + std::log(sum), 1e-3)
          << "size " << size;
      NormalTest::Answer answer;
      test.answer({y.data(), products.data()}, answer);
      EXPECT_NEAR(answer.log_models[2], test.log_pair({y.data(), products.data()}, 0, 1), 1e-12);
    }
  }
}

TEST(PlannedTest, ASampleOfPairsEstimatesTheirSum) {
  std::mt19937 rng(7);
  std::normal_distribution<double> normal;
  std::vector<NormalPlace> places;
  for (int k = 0; k < 40; ++k) {
    NormalPlace place{.kind = 0, .prior = 1.0 / 40, .nodes = MatrixXd::Zero(12, 5)};
    VectorXd along(12);
    for (double& v : along) v = normal(rng);
    for (int i = 1; i < 5; ++i) place.nodes.col(i) = along * 0.4 * i * (1.0 + 0.1 * i);
    places.push_back(std::move(place));
  }
  const std::vector<NormalModel> models = {{{0}, 0.4}, {{1}, 0.3}, {{2}, 0.3}};
  const NormalTest sampled(places, models, 96), all(places, models, 1000);
  double squares = 0.0, mean = 0.0;
  constexpr int kRepeats = 200;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    VectorXd y = VectorXd::Zero(12);
    if (repeat % 3 > 0) y += places[3].nodes.col(2);
    if (repeat % 3 > 1) y += places[17].nodes.col(3);
    for (double& v : y) v += normal(rng);
    NormalTest::Answer one, other;
    const MatrixXd products = sampled.products(y);
    sampled.answer({y.data(), products.data()}, one);
    all.answer({y.data(), products.data()}, other);
    EXPECT_LE(one.pairs[2].size(), 97u);
    const double error = one.log_models[2] - other.log_models[2];
    squares += error * error / kRepeats;
    mean += error / kRepeats;
  }
  EXPECT_LT(std::sqrt(squares), 0.1);
  EXPECT_LT(std::abs(mean), 0.03);
}

/// Places with effects of up to several hundred standard errors, along curved lines, and
/// interactions.
struct StrongEffects {
  std::vector<NormalPlace> places;
  std::vector<NormalInteraction> interactions;
};
StrongEffects strong_effects(int count) {
  std::mt19937 rng(8);
  std::normal_distribution<double> normal;
  constexpr int kData = 40, kNodes = 9;
  StrongEffects out;
  for (int k = 0; k < count; ++k) {
    NormalPlace place{.kind = 0, .prior = 1.0 / count, .nodes = MatrixXd::Zero(kData, kNodes)};
    VectorXd along(kData), bend(kData);
    for (int d = 0; d < kData; ++d) {
      along[d] = std::sin(0.3 * d + 0.1 * k) + 0.3 * normal(rng);
      bend[d] = std::cos(0.3 * d + 0.1 * k);
    }
    for (int i = 1; i < kNodes; ++i) {
      const double s = static_cast<double>(i) / (kNodes - 1);
      place.nodes.col(i) = 60.0 * s * along + 12.0 * s * s * bend;
    }
    out.places.push_back(std::move(place));
  }
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      NormalInteraction one{.a = a, .b = b, .data = VectorXd(kData)};
      for (double& v : one.data) v = 2.0 * normal(rng);
      out.interactions.push_back(std::move(one));
    }
  return out;
}

// Straight lines through the middle nodes describe these effects with errors of several standard
// errors. The approximate weights of pairs must not exclude the relevant pairs.
TEST(PlannedTest, StrongCurvedEffectsKeepTheRelevantPairs) {
  const auto [places, interactions] = strong_effects(40);
  const NormalTest test(places, {{{0}, 0.4}, {{1}, 0.3}, {{2}, 0.3}}, 96, interactions);
  std::mt19937 rng(9);
  std::normal_distribution<double> normal;
  double largest = 0.0;
  for (int repeat = 0; repeat < 60; ++repeat) {
    const int a = repeat % 20, b = 20 + (7 * repeat) % 20, i = 1 + repeat % 8, j = 8 - repeat % 7;
    VectorXd y = places[index(a)].nodes.col(i) + places[index(b)].nodes.col(j);
    for (double& v : y) v += normal(rng);
    const MatrixXd products = test.products(y);
    const NormalTest::Measured measured{y.data(), products.data()};
    NormalTest::Answer answer;
    test.answer(measured, answer);
    std::vector<double> terms;
    for (int c = 0; c < 40; ++c)
      for (int d = c + 1; d < 40; ++d)
        terms.push_back(test.log_pair(measured, c, d) + test.log_pair_prior(2, c, d));
    const double most = std::ranges::max(terms);
    double sum = 0.0;
    for (const double t : terms) sum += std::exp(t - most);
    largest = std::max(largest, std::abs(answer.log_models[2] - most - std::log(sum)));
  }
  EXPECT_LT(largest, 0.05);
}

TEST(PlannedTest, DataAgreeWithTheLikelihoodOfADamageRun) {
  const PlanCase plan = beam_plan(1);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const ScenarioSource source(structure, 11);
  PlannedStructure::Solver solver(structure);
  for (const TestDesign& design :
       {TestDesign{.sensors = {1, 3, 6}}, TestDesign{.sensors = {0, 1, 8}}, TestDesign{}}) {
    const TestData data(structure, plan.noise, design);
    VectorXd mean(data.size()), measured(data.size());
    for (std::uint64_t number = 1; number < 60; number += 2) {
      const Scenario scenario = source.draw(number, solver);
      ASSERT_EQ(scenario.defects.size(), 1u);
      const auto problem = make_damage_problem(simulated_case(plan, source, design, scenario), {});
      const auto likelihood = problem->problem.likelihood();
      const std::vector<double> x = {scenario.defects[0].location, scenario.defects[0].severity};
      const double gain = likelihood->log_likelihood(1, x) - likelihood->log_likelihood(0, {});
      data.mean(scenario.modes, mean);
      data.measured(scenario.modes, scenario.numbers, measured);
      const double by_plan = 0.5 * measured.squaredNorm() - 0.5 * (measured - mean).squaredNorm();
      // To first order in the noise and in the relative change of the frequencies.
      EXPECT_NEAR(by_plan, gain, 0.3 + 0.05 * std::abs(gain)) << "test " << number;
    }
  }
}

// Regression: the modes of a band were numbered from 1, so that the likelihood did not compute the
// highest of them.
TEST(PlannedTest, ModesOfABandKeepTheirNumbers) {
  PlanCase plan = beam_plan(1);
  plan.structure.modes = 3;
  const std::vector<double> all = elastic_frequencies(plan.damage_case.beam, {}, 8);
  plan.structure.low_hz = 0.5 * (all[4] + all[5]);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const ScenarioSource source(structure, 1);
  PlannedStructure::Solver solver(structure);
  const DamageCase simulated =
      simulated_case(plan, source, {.sensors = {1, 4}}, source.draw(0, solver));
  ASSERT_EQ(simulated.data.frequencies_hz.size(), 8U);
  EXPECT_TRUE(std::isnan(simulated.data.frequencies_hz[4]));
  EXPECT_NEAR(simulated.data.frequencies_hz[5] / all[5], 1.0, 0.2);
  EXPECT_TRUE(std::isnan(simulated.modal()->shapes(4, 0)));
  EXPECT_TRUE(std::isfinite(simulated.modal()->shapes(7, 1)));
}

TEST(PlannedTest, NoiseOfASensorDoesNotDependOnTheOtherSensors) {
  const PlanCase plan = beam_plan(1);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const TestNumbers numbers = TestNumbers::draw(structure, 1, 0);
  const TestData near_the_end(structure, plan.noise, {.sensors = {0, 1}});
  const TestData with_the_middle(structure, plan.noise, {.sensors = {0, 1, 4}});
  const VectorXd two = near_the_end.measured_shape(structure.intact(), numbers, 0);
  const VectorXd three = with_the_middle.measured_shape(structure.intact(), numbers, 0);
  EXPECT_EQ(two, three.head(2));
  // The distance of the shapes that whitening gives is the distance in standard deviations.
  VectorXd data(near_the_end.size());
  TestModes moved = structure.intact();
  const VectorXd at = moved.shapes.col(0)(std::vector<int>{0, 1});
  const VectorXd across = Eigen::Vector2d(-at[1], at[0]).normalized();
  const double step = 1e-4 * plan.noise.shape_sd * moved.shapes.col(0).cwiseAbs().maxCoeff();
  moved.shapes.col(0)(std::vector<int>{0, 1}) += step * across;
  near_the_end.mean(moved, data);
  EXPECT_NEAR(data.tail(data.size() - structure.modes()).head(2).norm(), 1e-4, 1e-7);
}

TEST(PlannedTest, AShapeThatNoSensorMeasuresHasNoData) {
  const PlanCase plan = beam_plan(1);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  // Mode 5 of ten equal parts has nodes at 0.2, 0.4, 0.6 and 0.8 of the span.
  const TestDesign design{.sensors = {1, 3, 5}};
  const TestData data(structure, plan.noise, design);
  EXPECT_TRUE(data.has_shape(3));
  EXPECT_FALSE(data.has_shape(4));
  const ScenarioSource source(structure, 11);
  PlannedStructure::Solver solver(structure);
  const DamageCase simulated = simulated_case(plan, source, design, source.draw(0, solver));
  EXPECT_TRUE(std::isnan(simulated.measured.modal()->shapes(4, 0)));
  EXPECT_TRUE(std::isfinite(simulated.measured.modal()->shapes(3, 0)));
}

/// A clamped column whose bending modes form pairs of stiffness ratio `ratio`.
PlanCase column_plan(double ratio, int modes) {
  fem::Structure s{.dimension = 3,
                   .nodes = {{"foot", {0.0, 0.0, 0.0}}, {"top", {0.0, 0.0, 3.0}}},
                   .members = {}};
  s.members.push_back({.name = "column",
                       .nodes = {0, 1},
                       .elements = 10,
                       .pieces = {{.to = 3.0,
                                   .material = {.young = 210e9, .poisson = 0.3, .density = 7850.0},
                                   .section = {.area = 6e-3,
                                               .second_moment_y = 2e-5,
                                               .second_moment_z = 2e-5 * ratio,
                                               .torsion_constant = 1e-5,
                                               .depth = 0.2}}}});
  s.supports.push_back({.node = 0, .fix = {true, true, true, true, true, true}});
  PlanCase plan;
  const fem::Mesh mesh(s);
  for (const double at : {1.0, 2.0, 3.0})
    for (const fem::Direction d : {fem::Direction::x, fem::Direction::y})
      plan.structure.candidates.push_back({"sensor", mesh.motion(0, at, d)});
  plan.damage_case.structure = std::make_shared<const StructureModel>(StructureModel{.nominal = s});
  DefectKind kind{.type = &defects::kReduction,
                  .name = "damage",
                  .plural = "damages",
                  .max_count = 1,
                  .location = inference::Uniform{0.0, 3.0},
                  .severity = inference::Prior(inference::Uniform{0.0, 0.6})};
  kind.line = SiteLine::of_members(mesh, {0});
  plan.damage_case.kinds = {std::move(kind)};
  plan.damage_case.data.frequencies_hz = {1.0};
  plan.damage_case.data.sd_hz = {1.0};
  complete(plan.damage_case);
  plan.structure.modes = modes;
  return plan;
}

TEST(PlannedTest, ACloseModeOutsideTheMeasuredOnesTurnsAShape) {
  const PlanCase inseparable = column_plan(1.0 + 1e-5, 1);
  EXPECT_FALSE(PlannedStructure(inseparable.damage_case, inseparable.structure).has_shape(0));
  const PlanCase close = column_plan(1.02, 1);
  const PlannedStructure structure(close.damage_case, close.structure);
  ASSERT_TRUE(structure.has_shape(0));
  EXPECT_EQ(structure.turn(0).mode, 1);
  EXPECT_EQ(structure.intact_shapes().cols(), 1);
  // The same rotation as with both modes measured.
  const PlanCase both = column_plan(1.02, 2);
  const PlannedStructure measured(both.damage_case, both.structure);
  EXPECT_DOUBLE_EQ(structure.turn(0).tau, measured.turn(0).tau);
  const TestNumbers numbers{.frequencies = VectorXd::Zero(1),
                            .with_mass = VectorXd::Zero(1),
                            .turns = VectorXd::Ones(1),
                            .shapes = MatrixXd::Zero(6, 1)};
  const TestData data(structure, close.noise, {.sensors = {4, 5}});
  const VectorXd shape = data.measured_shape(structure.intact(), numbers, 0);
  EXPECT_NEAR(shape.cwiseAbs().minCoeff() / shape.cwiseAbs().maxCoeff(), structure.turn(0).tau,
              0.02 * structure.turn(0).tau);
}

TEST(PlannedTest, ALocatedDamageIsRight) {
  const PlanCase plan = beam_plan(2);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const PlacePredictions predictions = predict_places(structure, 4, 1);
  const ScenarioSource source(structure, 5);
  const PreparedDesign design = prepare(structure, predictions, plan.noise, {.sensors = {1, 3, 6}});
  int located = 0, right = 0, neither = 0;
  for (const TestOutcome& o : simulate_tests(source, design, source.draw(0, 600, 1), 0.05)) {
    EXPECT_GE(o.located, 0.0);
    EXPECT_LE(o.located, 1.0);
    if (o.located > 0.5) {
      ++located;
      EXPECT_TRUE(o.right);
    }
    right += o.right;
    neither += !o.right;
  }
  EXPECT_GT(located, 200);
  EXPECT_GE(right, located);
  EXPECT_GT(neither, 50);
}

TEST(PlannedTest, ImagesOfASymmetricBeamAreSeparatedByTwoSensors) {
  const PlanCase plan = beam_plan(1);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const PlacePredictions predictions = predict_places(structure, 4, 1);
  const PreparedDesign alone = prepare(structure, predictions, plan.noise, {});
  const Confusion confusion = find_confusion(structure, alone.test, 0.05);
  ASSERT_FALSE(confusion.pairs.empty());
  int images = 0;
  for (const auto& [a, b] : confusion.pairs) images += a + b == 19;
  EXPECT_GE(images, 8);
  const Separations found =
      find_separations(structure, predictions, plan.noise, {}, confusion.pairs, {}, 1);
  ASSERT_TRUE(found.by_sensors);
  EXPECT_EQ(found.by_sensors->sensors.size(), 2u);
  // With these sensors, no confused pair of places is left, and every single sensor leaves one.
  const PreparedDesign both =
      prepare(structure, predictions, plan.noise, {.sensors = found.by_sensors->sensors});
  EXPECT_TRUE(find_confusion(structure, both.test, 0.05).pairs.empty());
  for (int sensor = 0; sensor < 9; ++sensor) {
    const PreparedDesign one = prepare(structure, predictions, plan.noise, {.sensors = {sensor}});
    EXPECT_FALSE(find_confusion(structure, one.test, 0.05).pairs.empty()) << sensor;
  }
}

TEST(PlannedTest, ChosenSensorsBeatOthersAndAreAllCompared) {
  const PlanCase plan = beam_plan(1);
  const PlannedStructure structure(plan.damage_case, plan.structure);
  const PlacePredictions predictions = predict_places(structure, 4, 1);
  const ScenarioSource source(structure, 3);
  ChoiceOptions how{.choose = 3, .threads = 1, .most_scenarios = 512};
  const SensorChoice all = choose_sensors(source, predictions, plan.noise, how);
  EXPECT_TRUE(all.exhaustive);
  how.exhaustive = 10;
  const SensorChoice searched = choose_sensors(source, predictions, plan.noise, how);
  EXPECT_FALSE(searched.exhaustive);
  EXPECT_LT(searched.compared, 400);
  // The search finds a layout as good as the best of all, within the noise of the estimates.
  EXPECT_GT(searched.best[0].score.value, all.best[0].score.value - 0.02);
  for (const auto& layout : random_layouts(9, 3, 3, 1)) {
    const auto scores = score_designs(source, predictions, plan.noise,
                                      {all.best[0].design, TestDesign{.sensors = layout}},
                                      {.scenarios = 1000, .threads = 1});
    EXPECT_GT(scores[0].right_place.value, scores[1].right_place.value - 0.02);
  }
}

TEST(PlannedTest, EffectiveIndependenceKeepsTheDeterminant) {
  // Three modes of five places: the best three rows by determinant of Φᵀ Φ.
  MatrixXd shapes(5, 3);
  shapes << 1.0, 0.0, 0.0, 0.9, 0.1, 0.0, 0.0, 1.0, 0.1, 0.0, 0.1, 1.0, 0.1, 0.1, 0.1;
  EXPECT_EQ(effective_independence(shapes, 3), (std::vector<int>{0, 2, 3}));
  EXPECT_EQ(kinetic_energy(shapes, 2), (std::vector<int>{2, 3}));
}

TEST(PlannedTest, RefusesImpossibleModels) {
  const MatrixXd nodes = MatrixXd::Ones(2, 2);
  const NormalPlace place{.kind = 0, .prior = 1.0, .nodes = nodes};
  EXPECT_THROW(NormalTest({place}, {{{1}, 1.0}}), std::invalid_argument);
  EXPECT_THROW(NormalTest({place}, {{{0}, 0.5}, {{3}, 0.5}}), std::invalid_argument);
  EXPECT_THROW(NormalTest({place}, {{{0}, 0.5}, {{2}, 0.5}}), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(summarise({{.model = 1}}, {{{0}, 0.5}, {{1}, 0.5}}, 0.05)),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::identification::planning
