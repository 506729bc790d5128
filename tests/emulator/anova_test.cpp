#include "emulator/anova.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wheeltap::emulator {
namespace {

constexpr std::size_t kResponses = 3;
using Point = std::vector<double>;

/// An effect of each component (location, size), of each pair, and optionally of each triple, in
/// the additive quantity, shifted to the range where that quantity exists.
double effects(const Point& x, std::size_t r, bool triples) {
  const std::size_t k = x.size() / 2;
  const auto one = [&](std::size_t i) {
    return x[2 * i + 1] * std::sin((static_cast<double>(r) + 1.0) * x[2 * i]);
  };
  double sum = 0;
  for (std::size_t i = 0; i < k; ++i) {
    sum += one(i);
    for (std::size_t j = 0; j < i; ++j) {
      sum += 0.3 * one(i) * one(j);
      for (std::size_t l = 0; triples && l < j; ++l) sum += 0.2 * one(i) * one(j) * one(l);
    }
  }
  return sum;
}

Predictor model(Additive additive, bool triples = false) {
  return [=](std::span<const double> x, std::span<double> y) {
    for (std::size_t r = 0; r < y.size(); ++r) {
      const double e = 0.1 * effects({x.begin(), x.end()}, r, triples);
      switch (additive) {
        case Additive::response:
          y[r] = 2 + e;
          break;
        case Additive::logarithm:
          y[r] = std::exp(e);
          break;
        case Additive::square:
          y[r] = std::sqrt(2 + e);
          break;
        case Additive::inverse_square:
          y[r] = 1 / std::sqrt(2 + e);
          break;
      }
    }
  };
}

AnovaEmulator emulator_of(const Predictor& truth, Additive additive) {
  std::vector<double> baseline(kResponses);
  truth({}, baseline);
  return {baseline, 2, truth, truth, additive};
}

std::vector<Factor> components(std::size_t k) {
  std::vector<Factor> factors;
  for (std::size_t i = 0; i < k; ++i) {
    const std::string number = std::to_string(i);
    factors.push_back({std::string("location").append(number), "m", {0, 3}});
    factors.push_back({std::string("size").append(number), "", {0, 1}});
  }
  return factors;
}

double largest_error(Additive additive, std::size_t k, bool triples) {
  const Predictor truth = model(additive, triples);
  const AnovaEmulator f = emulator_of(truth, additive);
  const auto errors = validate(
      components(k), kResponses, [&] { return Model(truth); },
      [&](std::span<const double> x, std::span<double> y) { f.evaluate(x, y); }, {.runs = 100});
  double worst = 0;
  for (const HoldoutError& e : errors) worst = std::max(worst, e.max_error);
  return worst;
}

TEST(Anova, IsExactWithoutThirdOrderEffects) {
  for (Additive additive :
       {Additive::response, Additive::logarithm, Additive::square, Additive::inverse_square})
    for (std::size_t k = 1; k <= 6; ++k) EXPECT_LT(largest_error(additive, k, false), 1e-12) << k;
}

TEST(Anova, GivesTheBaselineWithoutComponents) {
  for (Additive additive :
       {Additive::response, Additive::logarithm, Additive::square, Additive::inverse_square}) {
    const AnovaEmulator f = emulator_of(model(additive), additive);
    std::vector<double> y(kResponses), expected(kResponses);
    f.evaluate({}, y);
    model(additive)({}, expected);
    for (std::size_t r = 0; r < kResponses; ++r) EXPECT_NEAR(y[r], expected[r], 1e-15);
  }
}

TEST(Anova, RemainderIsTheThirdOrderTerm) {
  EXPECT_LT(largest_error(Additive::response, 2, true), 1e-12);
  const Predictor truth = model(Additive::response, true);
  const AnovaEmulator f = emulator_of(truth, Additive::response);
  const Point x{0.5, 0.9, 1.5, 0.7, 2.5, 0.8};
  std::vector<double> y(kResponses), expected(kResponses);
  f.evaluate(x, y);
  truth(x, expected);
  for (std::size_t r = 0; r < kResponses; ++r) {
    double triple = 0.1 * 0.2;
    for (std::size_t i = 0; i < 3; ++i)
      triple *= x[2 * i + 1] * std::sin((static_cast<double>(r) + 1.0) * x[2 * i]);
    EXPECT_NEAR(expected[r] - y[r], triple, 1e-14);
  }
}

TEST(Anova, DoesNotDependOnTheOrderOfComponents) {
  const AnovaEmulator f = emulator_of(model(Additive::square, true), Additive::square);
  std::vector<double> a(kResponses), b(kResponses);
  f.evaluate(Point{0.5, 0.9, 1.5, 0.7, 2.5, 0.8}, a);
  f.evaluate(Point{2.5, 0.8, 0.5, 0.9, 1.5, 0.7}, b);
  for (std::size_t r = 0; r < kResponses; ++r) EXPECT_NEAR(a[r], b[r], 1e-14);
}

TEST(Anova, GivesNaNForAnImpossibleSum) {
  const Predictor halves = [](std::span<const double>, std::span<double> y) { y[0] = 0.5; };
  const AnovaEmulator f({1.0}, 1, halves, halves, Additive::square);
  double y = 0;
  f.evaluate(Point(6, 0.0), {&y, 1});  // 15/4 - 4·6/4 + 10 > 0
  EXPECT_FALSE(std::isnan(y));
  const Predictor low = [](std::span<const double>, std::span<double> out) { out[0] = 0.01; };
  const AnovaEmulator g({1.0}, 1, halves, low, Additive::square);
  g.evaluate(Point(3, 0.0), {&y, 1});  // 3·0.01² - 3/4 + 1 > 0
  EXPECT_FALSE(std::isnan(y));
  const AnovaEmulator h({0.1}, 1, halves, low, Additive::square);
  h.evaluate(Point(3, 0.0), {&y, 1});  // 3·0.01² - 3/4 + 0.01 < 0
  EXPECT_TRUE(std::isnan(y));
}

TEST(Anova, RejectsInvalidInput) {
  const Predictor truth = model(Additive::response);
  EXPECT_THROW(AnovaEmulator({}, 2, truth, truth), std::invalid_argument);
  EXPECT_THROW(AnovaEmulator({1.0}, 0, truth, truth), std::invalid_argument);
  EXPECT_THROW(AnovaEmulator({-1.0}, 2, truth, truth, Additive::logarithm), std::invalid_argument);
  const AnovaEmulator f = emulator_of(truth, Additive::response);
  std::vector<double> y(kResponses);
  EXPECT_THROW(f.evaluate(Point{0.1, 0.2, 0.3}, y), std::invalid_argument);
  y.pop_back();
  EXPECT_THROW(f.evaluate(Point{0.1, 0.2}, y), std::invalid_argument);
  EXPECT_EQ(additive_named("inverse-square"), Additive::inverse_square);
  EXPECT_THROW((void)additive_named("cube"), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
