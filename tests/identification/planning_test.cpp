// Evidences, probability of detection and expected information of planned tests against quadrature.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/constants.hpp"
#include "base/index.hpp"
#include "base/random.hpp"
#include "identification/planning/test_scores.hpp"

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
    test.answer(products.data(), answer);
    outcomes.push_back(scorer.score(truth, products.data(), answer));
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
      test.answer(products.data(), answer);
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
      EXPECT_NEAR(test.log_pair(products.data(), 0, 1), most + std::log(sum), 1e-3)
          << "size " << size;
      NormalTest::Answer answer;
      test.answer(products.data(), answer);
      EXPECT_NEAR(answer.log_models[2], test.log_pair(products.data(), 0, 1), 1e-12);
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
    sampled.answer(sampled.products(y).data(), one);
    all.answer(all.products(y).data(), other);
    EXPECT_LE(one.pairs[2].size(), 97u);
    const double error = one.log_models[2] - other.log_models[2];
    squares += error * error / kRepeats;
    mean += error / kRepeats;
  }
  EXPECT_LT(std::sqrt(squares), 0.1);
  EXPECT_LT(std::abs(mean), 0.03);
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
