#include "inference/search/mode_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "inference/model/model_posterior.hpp"
#include "inference/statistics/standard_normal.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

using Function = std::function<double(std::span<const double>)>;

class Given : public Likelihood {
 public:
  explicit Given(Function f) : f_(std::move(f)) {}
  double log_likelihood(int, std::span<const double> x) override { return f_(x); }

 private:
  Function f_;
};

// One model over standard normal parameters.
Problem problem_of(int dimension, Function f) {
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (int i = 0; i < dimension; ++i) {
    names.push_back("p" + std::to_string(i));
    parameters.push_back({names.back(), Normal{0.0, 1.0}});
  }
  return {.space = ModelSpace::of_models(parameters, {{"m", 1.0, names}}),
          .likelihood = [f] { return std::make_unique<Given>(f); }};
}

// Normals of width s about ± 1 on the first axis, of these weights.
Function two_peaks(double left, double s) {
  return [=](std::span<const double> x) {
    double a = std::log(left), b = std::log(1.0 - left);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double centre = i == 0 ? 1.0 : 0.0;
      a -= 0.5 * std::pow((x[i] + centre) / s, 2.0);
      b -= 0.5 * std::pow((x[i] - centre) / s, 2.0);
    }
    return log_sum_exp(a, b);
  };
}

TEST(ModeSearch, FindsBothPeaksWithTheirCurvatures) {
  constexpr double kWidth = 0.05;
  const Problem problem = problem_of(3, two_peaks(0.5, kWidth));
  const ModeSearch found = search_modes(problem, 0, {.climbs = 200});
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_EQ(found.climbs, 200);
  EXPECT_EQ(found.modes[0].climbs + found.modes[1].climbs, 200);
  // In standard normal coordinates, the prior adds its curvature.
  const double variance = 1.0 / (1.0 / (kWidth * kWidth) + 1.0);
  for (const Mode& mode : found.modes) {
    EXPECT_NEAR(std::fabs(mode.z[0]), variance / (kWidth * kWidth), 0.1 * kWidth);
    EXPECT_NEAR(mode.z[1], 0.0, 0.1 * kWidth);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(mode.covariance(i, i) / variance, 1.0, 0.02);
    // Laplace's method is exact for a normal: ½ ∏ √(2π) s · N(±1; 0, 1 + s²) N(0; 0, 1 + s²)².
    const double exact = std::log(0.5) + 3.0 * (std::log(kWidth) + kLogSqrt2Pi) -
                         3.0 * (kLogSqrt2Pi + 0.5 * std::log1p(kWidth * kWidth)) -
                         0.5 / (1.0 + kWidth * kWidth);
    EXPECT_NEAR(mode.log_mass, exact, 0.03);
  }
}

TEST(ModeSearch, NeedsFewCallsPerStartForANormalPosterior) {
  const Problem problem = problem_of(10, [](std::span<const double> x) {
    double sum = 0.0;
    for (const double v : x) sum -= 0.5 * std::pow((v - 0.3) / 0.01, 2.0);
    return sum;
  });
  const ModeSearch found = search_modes(problem, 0, {.climbs = 2000});
  ASSERT_EQ(found.modes.size(), 1U);
  // Gradient by differences, the step, and three check points on the way.
  EXPECT_LT(static_cast<double>(found.likelihood_evaluations) / 2000.0, 10.0 + 8.0);
}

TEST(ModeSearch, DoesNotStepOverANarrowPeak) {
  // Most starts climb to the broad peak at 2; half of them pass the narrow one at 0.
  const Problem problem = problem_of(1, [](std::span<const double> x) {
    return log_sum_exp(-0.5 * std::pow((x[0] - 2.0) / 0.2, 2.0),
                       4.0 - 0.5 * std::pow(x[0] / 0.02, 2.0));
  });
  const ModeSearch found = search_modes(problem, 0, {.climbs = 500});
  EXPECT_EQ(found.modes.size(), 2U);
}

TEST(ModeSearch, CountsAPlateauAsOneMode) {
  const Problem problem = problem_of(2, [](std::span<const double>) { return 0.0; });
  const ModeSearch found = search_modes(problem, 0, {.climbs = 50});
  ASSERT_EQ(found.modes.size(), 1U);
  EXPECT_NEAR(found.modes[0].log_mass, 0.0, 1e-3);  // the prior's whole mass
}

TEST(ModeSearch, SortsComponents) {
  const std::vector<double> data{0.5, 0.2, -0.3, 0.4, 0.1, 0.2};
  const Problem problem = toy::bump_problem(data, {1.0, 1.0, 1.0});
  const ModeSearch found = search_modes(problem, 2, {.climbs = 100});
  ASSERT_FALSE(found.modes.empty());
  ModelPosterior posterior(problem, 2);
  for (const Mode& mode : found.modes)
    EXPECT_NEAR(posterior(mode.z).log_posterior(), mode.log_posterior, 1e-9);
}

// More separate modes than a search keeps: it counts the others, and their share.
TEST(ModeSearch, CountsTheModesThatItLeavesOut) {
  const Problem problem = problem_of(2, [](std::span<const double> x) {
    double sum = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 20; ++j)
        sum = log_sum_exp(sum, -0.5 * (std::pow((x[0] - 0.15 * (i - 9.5)) / 0.015, 2.0) +
                                       std::pow((x[1] - 0.15 * (j - 9.5)) / 0.015, 2.0)));
    return sum;
  });
  const ModeSearch found = search_modes(problem, 0, {.climbs = 6000});
  EXPECT_EQ(found.modes.size(), 300U);
  EXPECT_GT(found.left_out, 50);
  EXPECT_LE(found.left_out, 110);  // a few are found twice
  EXPECT_GT(found.left_out_share, 0.05);
  const ModeSearch few = search_modes(problem_of(2, two_peaks(0.5, 0.1)), 0, {.climbs = 50});
  EXPECT_EQ(few.left_out, 0);
  EXPECT_EQ(few.left_out_share, 0.0);
}

// With exact derivatives, climbs need no differences, and neither do the modes' curvatures. A
// gradient that fails at some points is asked again elsewhere.
TEST(ModeSearch, UsesExactDerivatives) {
  class Exact : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      double sum = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) sum -= 0.5 * std::pow(residual(x, i), 2.0);
      return sum;
    }
    bool gradient(int, std::span<const double> x, std::span<double> out) override {
      std::ranges::fill(out, 0.0);
      for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t j = 0; j < x.size(); ++j) out[j] -= residual(x, i) * slope(x, i, j);
      return true;
    }
    bool gauss_newton(int, std::span<const double> x, std::span<const double> steps,
                      std::span<double> gradient, std::span<double> information) override {
      if (x[0] > 1.5) return false;
      const std::size_t d = x.size();
      static_cast<void>(this->gradient(0, x, gradient));
      std::ranges::fill(information, 0.0);
      for (std::size_t j = 0; j < d; ++j) {
        gradient[j] *= steps[j];
        for (std::size_t k = 0; k < d; ++k)
          for (std::size_t i = 0; i < d; ++i)
            information[j * d + k] += steps[j] * steps[k] * slope(x, i, j) * slope(x, i, k);
      }
      return true;
    }
    [[nodiscard]] bool has_exact_derivatives() const override { return exact; }
    bool exact = true;

   private:
    static double residual(std::span<const double> x, std::size_t i) {
      return (x[i] + 0.3 * x[(i + 1) % x.size()] * x[(i + 1) % x.size()] - 0.5) / 0.02;
    }
    static double slope(std::span<const double> x, std::size_t i, std::size_t j) {
      if (j == i) return 1.0 / 0.02;
      return j == (i + 1) % x.size() ? 0.6 * x[j] / 0.02 : 0.0;
    }
  };
  Problem problem =
      problem_of(15, [](std::span<const double> x) { return Exact().log_likelihood(0, x); });
  const ModeSearch without = search_modes(problem, 0, {.climbs = 200});
  problem.likelihood = [] { return std::make_unique<Exact>(); };
  const ModeSearch with = search_modes(problem, 0, {.climbs = 200});
  ASSERT_FALSE(with.modes.empty());
  EXPECT_EQ(with.modes.size(), without.modes.size());
  EXPECT_NEAR(with.modes[0].log_mass, without.modes[0].log_mass, 0.02);
  EXPECT_LT(5 * with.likelihood_evaluations, without.likelihood_evaluations);
  // A budget allows as many climbs as without exact derivatives.
  const ModeSearch budgeted = search_modes(problem, 0, {.budget = 20'000});
  EXPECT_LT(budgeted.likelihood_evaluations, 10'000);
  EXPECT_GE(budgeted.climbs, kFewestClimbs);
}

// If the likelihood has a gradient, climbs to the same mode need fewer calls.
TEST(ModeSearch, UsesTheGradientOfTheLikelihood) {
  class Sloped : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      double sum = 0.0;
      for (const double v : x) sum -= 0.5 * std::pow((v - 0.3) / 0.01, 2.0);
      return sum;
    }
    bool gradient(int, std::span<const double> x, std::span<double> out) override {
      for (std::size_t i = 0; i < x.size(); ++i) out[i] = -(x[i] - 0.3) / 1e-4;
      return true;
    }
  };
  Problem problem =
      problem_of(20, [](std::span<const double> x) { return Sloped().log_likelihood(0, x); });
  const ModeSearch without = search_modes(problem, 0, {.climbs = 500});
  problem.likelihood = [] { return std::make_unique<Sloped>(); };
  const ModeSearch with = search_modes(problem, 0, {.climbs = 500});
  ASSERT_EQ(with.modes.size(), 1U);
  EXPECT_NEAR(with.modes[0].log_mass, without.modes[0].log_mass, 0.01);
  EXPECT_LT(2 * with.likelihood_evaluations, without.likelihood_evaluations);
}

// The gradient of a set refers to its components in the given order.
TEST(ModeSearch, GradientsOfSetsKeepTheirOrder) {
  class Sum : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      double sum = 0.0;
      for (std::size_t i = 0; i + 1 < x.size(); i += 2) sum += x[i] * x[i] * x[i + 1];
      return sum;
    }
    bool gradient(int, std::span<const double> x, std::span<double> out) override {
      for (std::size_t i = 0; i + 1 < x.size(); i += 2) {
        out[i] = 2.0 * x[i] * x[i + 1];
        out[i + 1] = x[i] * x[i];
      }
      return true;
    }
  };
  const Problem problem{
      .space = ModelSpace::of_components(
          {}, {{"thing", "things", {{"a", Normal{0.0, 1.0}}, {"b", Normal{0.0, 1.0}}}}},
          {{{3}, 1.0}}),
      .likelihood = [] { return std::make_unique<Sum>(); }};
  ModelPosterior posterior(problem, 0);
  const std::vector<double> z{0.7, 0.1, -0.4, 0.9, 0.2, -0.6};
  std::vector<double> g(6);
  ASSERT_TRUE(posterior.gradient(z, g));
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double slope = i % 2 == 0 ? 2.0 * z[i] * z[i + 1] : z[i - 1] * z[i - 1];
    EXPECT_NEAR(g[i], slope - z[i], 1e-9);
  }
}

// Three sources of unknown place and strength, each with a narrow effect: a climb from the prior
// finds all three only if each place begins near one of them.
TEST(ModeSearch, ReplacesSingleComponentsOfLowerModes) {
  class Sources final : public Likelihood {
   public:
    double log_likelihood(int /*model*/, std::span<const double> x) override {
      constexpr double kAt[] = {0.18, 0.47, 0.83}, kStrength[] = {1.0, 0.7, 1.3};
      double sum = 0.0;
      for (int i = 0; i <= 200; ++i) {
        const double at = i / 200.0;
        double residual = 0.0;
        for (int c = 0; c < 3; ++c) residual += kStrength[c] * effect(at - kAt[c]);
        for (std::size_t c = 0; c < x.size(); c += 2) residual -= x[c + 1] * effect(at - x[c]);
        sum -= 0.5 * residual * residual / (0.02 * 0.02);
      }
      return sum;
    }

   private:
    static double effect(double distance) { return std::exp(-0.5 * std::pow(distance / 0.008, 2)); }
  };
  const Problem problem{
      .space = ModelSpace::of_components({},
                                         {{"source",
                                           "sources",
                                           {{"place", Uniform{.lower = 0.0, .upper = 1.0}},
                                            {"strength", Uniform{.lower = 0.0, .upper = 2.0}}}}},
                                         {{{3}, 1.0}}),
      .likelihood = [] { return std::make_unique<Sources>(); }};
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ModeSearch search = search_modes(problem, 0, {.seed = seed, .climbs = 4, .threads = 1});
    double best = -kInfinity;
    for (const Mode& mode : search.modes) best = std::max(best, mode.log_posterior);
    found += best > -30.0;
    EXPECT_EQ(search.climbs, 4);
  }
  EXPECT_GE(found, 18);  // 12 without replacements
}

TEST(ModeSearch, DoesNotDependOnThreads) {
  const Problem problem = problem_of(2, two_peaks(0.2, 0.1));
  const ModeSearch one = search_modes(problem, 0, {.climbs = 64, .threads = 1});
  const ModeSearch four = search_modes(problem, 0, {.climbs = 64, .threads = 4});
  ASSERT_EQ(one.modes.size(), four.modes.size());
  for (std::size_t k = 0; k < one.modes.size(); ++k) EXPECT_EQ(one.modes[k].z, four.modes[k].z);
  EXPECT_EQ(one.likelihood_evaluations, four.likelihood_evaluations);
}

// Searches with n climbs miss a mode whose basin holds p in a share (1 - p)^n.
TEST(ModeSearch, MissRateMatchesItsResolution) {
  // A step at x > 2.326: a hundredth of the prior, and no gradient outside points to it.
  const Problem problem = problem_of(1, [](std::span<const double> x) {
    return x[0] > 2.3263478740408408 ? 10.0 - 50.0 * std::pow(x[0] - 3.0, 2.0)
                                     : -50.0 * std::pow(x[0], 2.0);
  });
  constexpr int kSearches = 400;
  constexpr long kClimbs = 60;
  int missed = 0;
  for (int s = 0; s < kSearches; ++s) {
    const ModeSearch found =
        search_modes(problem, 0, {.seed = static_cast<std::uint64_t>(s + 1), .climbs = kClimbs});
    bool seen = false;
    for (const Mode& mode : found.modes) seen = seen || mode.z[0] > 2.3;
    missed += seen ? 0 : 1;
  }
  const double expected = std::pow(0.99, kClimbs);
  const double error = std::sqrt(expected * (1.0 - expected) / kSearches);
  EXPECT_NEAR(static_cast<double>(missed) / kSearches, expected, 4.9 * error);
}

TEST(ModeSearch, ResolutionIsMissedByOneSearchInAHundred) {
  for (const long n : {1L, 30L, 10000L})
    EXPECT_NEAR(std::pow(1.0 - search_resolution(n), static_cast<double>(n)), 0.01, 1e-12);
  EXPECT_EQ(search_resolution(0), 1.0);
}

// A record of 400 samples whose likelihood is possible only near its mode: both climbs from the
// prior begin at impossible points, and only the given start succeeds.
TEST(ModeSearch, UsesGivenStartsIfNoDrawOfThePriorIsPossible) {
  const auto island = [](std::span<const double> x) {
    const double e = (x[0] - 6.0) / 0.1;
    return std::abs(e) < 20.0 ? -0.5 * e * e : -std::numeric_limits<double>::infinity();
  };
  Problem problem = problem_of(1, island);
  problem.samples = 400;
  problem.shortened = [island](long) {
    return std::make_shared<const Problem>(problem_of(1, island));
  };
  EXPECT_TRUE(search_modes(problem, 0, {.climbs = 2}).modes.empty());
  const ModeSearch found = search_modes(problem, 0, {.climbs = 2, .starts = {{5.5}}});
  ASSERT_EQ(found.modes.size(), 1U);
  EXPECT_NEAR(found.modes[0].z[0], 6.0 * 100.0 / 101.0, 1e-3);
}

// sin(x e^{0.06 t}), t < n: twice the record has e^{0.06 n} times the information on x, so that the
// mode of n samples does not predict it. `jump` is added to the phase from sample 100 on.
Problem growing_ever_faster(long n, double jump) {
  const auto signal = [](double x, long t) {
    return std::sin(x * std::exp(0.06 * static_cast<double>(t)));
  };
  std::vector<double> data;
  for (long t = 0; t < n; ++t) {
    base::Random random(1, 0, static_cast<std::uint64_t>(t), base::Purpose::prediction);
    data.push_back((t < 100 ? signal(0.7, t) : signal(0.7 + jump, t)) + 0.05 * random.normal());
  }
  Problem problem = problem_of(1, [signal, data = std::move(data)](std::span<const double> x) {
    double sum = 0.0;
    for (std::size_t t = 0; t < data.size(); ++t)
      sum -= 0.5 * std::pow((data[t] - signal(x[0], static_cast<long>(t))) / 0.05, 2);
    return sum;
  });
  problem.samples = n;
  problem.shortened = [jump](long few) {
    return std::make_shared<const Problem>(growing_ever_faster(few, jump));
  };
  return problem;
}

TEST(ModeSearch, FollowsAModeThatTwiceTheRecordDoesNotShow) {
  const Problem problem = growing_ever_faster(200, 0.0);
  const ModeSearch found = search_modes(problem, 0, {.climbs = 200});
  ASSERT_FALSE(found.modes.empty());
  // The record determines x to about 0.05 e^{-0.06 200}.
  EXPECT_NEAR(found.modes[0].z[0], 0.7, 1e-6);
}

// If the model does not explain the later samples, the search ends after a few climbs.
TEST(ModeSearch, SpendsFewCallsIfTheModelDoesNotFit) {
  const auto spent = [](double jump) {
    return search_modes(growing_ever_faster(120, jump), 0, {.climbs = 200}).likelihood_evaluations;
  };
  EXPECT_LT(static_cast<double>(spent(0.3)), 1.5 * static_cast<double>(spent(0.0)));
}

}  // namespace
}  // namespace wheeltap::inference
