#include "inference/model/target.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "base/constants.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

// One parameter, x = z.
Problem of_function(FunctionLikelihood::Function f) {
  return one_model({{"a", Normal{0.0, 1.0}}}, std::move(f));
}

State at(double z) {
  State state;
  state.z = {z};
  return state;
}

// A fault for |x| > 3, one draw of the prior in 370.
Problem faulty_at_the_edge(double fault) {
  return of_function(
      [fault](int, std::span<const double> x) { return std::fabs(x[0]) > 3.0 ? fault : -x[0]; });
}

TEST(Target, CountsRareNanOrInfinityAsImpossible) {
  for (const double fault : {std::nan(""), kInfinity}) {
    const Problem problem = faulty_at_the_edge(fault);
    Target target(problem, false);
    State state = at(1.0);
    target.evaluate(state);
    EXPECT_EQ(state.log_likelihood, -1.0);
    EXPECT_EQ(target.impossible(), 0);
    state = at(4.0);
    target.evaluate(state);
    EXPECT_EQ(state.log_likelihood, -kInfinity);
    EXPECT_EQ(state.log_screen, -kInfinity);
    EXPECT_EQ(target.impossible(), 1);

    std::vector<State> several{at(-1.0), at(-4.0), at(kInfinity), at(2.0)};
    target.evaluate(several);
    EXPECT_EQ(several[0].log_likelihood, 1.0);
    EXPECT_EQ(several[1].log_likelihood, -kInfinity);
    EXPECT_EQ(several[2].log_likelihood, -kInfinity);
    EXPECT_EQ(several[3].log_likelihood, -2.0);
    EXPECT_EQ(target.impossible(), 2);
    EXPECT_EQ(target.evaluations(), 5);

    base::Random random(1, 0, 0, base::Purpose::test);
    for (int i = 0; i < 20000; ++i) {
      target.draw_prior(0, random, state);
      target.evaluate(state);
    }
    EXPECT_NEAR(static_cast<double>(target.impossible()), 54.0, 40.0);  // 5 sds
  }
}

TEST(Target, CountsFaultsOfApproximationAndLikelihoodSeparately) {
  Problem problem = faulty_at_the_edge(std::nan(""));
  problem.screen = [] {
    return std::make_unique<FunctionLikelihood>(
        [](int, std::span<const double> x) { return x[0] < -3.0 ? kInfinity : 0.0; });
  };
  Target target(problem, false);
  State state = at(-4.0);
  target.screen(state);
  EXPECT_EQ(state.log_screen, -kInfinity);
  target.complete(state);
  EXPECT_EQ(target.full_evaluations(), 0);
  EXPECT_EQ(target.impossible(), 1);
  state = at(4.0);
  target.evaluate(state);
  EXPECT_EQ(state.log_screen, 0.0);
  EXPECT_EQ(state.log_likelihood, -kInfinity);
  EXPECT_EQ(target.impossible(), 2);
}

// The run's message and the number of evaluations, if x cycles through `share` of faulty values.
std::pair<std::string, long> failure(double share) {
  const Problem problem =
      of_function([](int, std::span<const double> x) { return x[0] < 0.0 ? std::nan("") : 0.0; });
  Target target(problem, false);
  double owed = 0.0;
  for (long i = 1; i <= 5000; ++i) {
    owed += share;
    const bool fault = owed >= 1.0;
    if (fault) owed -= 1.0;
    State state = at(fault ? -1e-70 : 1.0);
    try {
      target.evaluate(state);
    } catch (const LikelihoodError& error) {
      return {error.what(), i};
    }
  }
  return {};
}

TEST(Target, ThrowsIfFaultsAreFrequent) {
  EXPECT_EQ(failure(0.005).second, 0);
  const auto [often, after] = failure(0.02);
  EXPECT_GE(after, 1000);
  EXPECT_LE(after, 1050);
  EXPECT_NE(often.find("'only' at a = -1e-70"), std::string::npos) << often;
  EXPECT_NE(often.find("log likelihood is nan"), std::string::npos) << often;
  EXPECT_EQ(failure(1.0).second, 20) << "a likelihood that always fails is reported at once";
}

TEST(Target, ThrowsAtOnceForAFaultyPriorFactor) {
  for (const double fault : {std::nan(""), kInfinity}) {
    Problem problem = of_function([](int, std::span<const double>) { return 0.0; });
    problem.log_prior_factor = [fault](int, std::span<const double>) { return fault; };
    Target target(problem, false);
    State state = at(0.0);
    EXPECT_THROW(target.evaluate(state), LikelihoodError);
  }
}

TEST(Target, RejectsAFactoryThatReturnsNull) {
  Problem problem = of_function([](int, std::span<const double>) { return 0.0; });
  problem.screen = [] { return std::unique_ptr<Likelihood>(); };
  EXPECT_THROW(Target(problem, false), std::invalid_argument);
  problem.screen = nullptr;
  EXPECT_NO_THROW(Target(problem, false));
  problem.likelihood = [] { return std::unique_ptr<Likelihood>(); };
  try {
    const Target target(problem, false);
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("the problem's likelihood factory returned null"),
              std::string::npos)
        << error.what();
  }
  EXPECT_NO_THROW(Target(problem, true));
  problem.likelihood = nullptr;
  EXPECT_THROW(Target(problem, false), std::invalid_argument);
  EXPECT_NO_THROW(Target(problem, true));
}

// ln p = Σ_i -½ (g(x_i) - i)², g = ln(1 + x²): smooth, and different for each parameter.
class Smooth : public Likelihood {
 public:
  explicit Smooth(bool offers) : offers_(offers) {}
  double log_likelihood(int, std::span<const double> x) override {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double e = std::log1p(x[i] * x[i]) - static_cast<double>(i);
      sum -= 0.5 * e * e;
    }
    return sum;
  }
  bool gradient(int, std::span<const double> x, std::span<double> out) override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double e = std::log1p(x[i] * x[i]) - static_cast<double>(i);
      out[i] = -e * 2.0 * x[i] / (1.0 + x[i] * x[i]);
    }
    return offers_;
  }

 private:
  bool offers_;
};

TEST(Likelihood, AnEvaluationHoldsNothingOfTheOneBefore) {
  Smooth likelihood(true);
  Evaluation out{
      .log_likelihood = 1.0, .prediction = {2.0}, .residuals = {3.0}, .noise_scale = 4.0};
  const std::vector<double> x = {0.5};
  likelihood.evaluate(-kInfinity, 0, x, out);
  EXPECT_EQ(out.log_likelihood, likelihood.log_likelihood(0, x));
  EXPECT_TRUE(out.prediction.empty());
  EXPECT_TRUE(out.residuals.empty());
  EXPECT_EQ(out.noise_scale, 1.0);
}

Problem smooth(bool offers) {
  Problem problem = one_model({{"uniform", Uniform{-3.0, 5.0}},
                               {"log uniform", LogUniform{1e-3, 1e4}},
                               {"normal", Normal{2.0, 0.5}},
                               {"log normal", LogNormal{-1.0, 0.7}},
                               {"half normal", HalfNormal{3.0}},
                               {"gamma", Gamma{0.4, 2.0}},
                               {"beta", Beta{2.0, 3.0, -1.0, 4.0}},
                               {"truncated normal", TruncatedNormal{0.0, 1.0, 3.0, kInfinity}}},
                              nullptr);
  problem.likelihood = [offers] { return std::make_unique<Smooth>(offers); };
  return problem;
}

TEST(Target, GradientEqualsCentralDifferencesForEveryPrior) {
  const Problem problem = smooth(true);
  Target target(problem, false);
  base::Random random(3, 0, 0, base::Purpose::test);
  for (int n = 0; n < 100; ++n) {
    State state;
    target.draw_prior(0, random, state);
    target.evaluate(state);
    std::vector<double> gradient(state.z.size());
    const long before = target.evaluations();
    ASSERT_TRUE(target.gradient(state, gradient));
    EXPECT_EQ(target.evaluations(), before + 1);
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      constexpr double kStep = 1e-3;
      const auto at = [&](double steps) {
        State moved = state;
        moved.z[i] += steps * kStep;
        target.evaluate(moved);
        return target.log_prior(moved) + moved.log_likelihood;
      };
      const double expected = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * kStep);
      EXPECT_NEAR(gradient[i], expected, 1e-6 * (1.0 + std::fabs(expected)))
          << problem.space.parameter_name(0, static_cast<int>(i)) << " at z = " << state.z[i];
    }
  }
}

TEST(Target, OffersAGradientOnlyOfTheWholePosterior) {
  State state;
  state.z.assign(8, 0.3);
  std::vector<double> dz(8);
  const auto offered = [&](const Problem& problem, bool prior_only = false) {
    Target target(problem, prior_only);
    target.evaluate(state);
    return target.gradient(state, dz);
  };
  EXPECT_TRUE(offered(smooth(true)));
  EXPECT_FALSE(offered(smooth(false)));
  EXPECT_TRUE(offered(smooth(false), true));
  for (const double d : dz) EXPECT_EQ(d, -0.3);
  Problem screened = smooth(true);
  screened.screen = screened.likelihood;
  EXPECT_FALSE(offered(screened));
  Problem with_factor = smooth(true);
  with_factor.log_prior_factor = [](int, std::span<const double>) { return 0.0; };
  EXPECT_FALSE(offered(with_factor));
  state.z[0] = kInfinity;
  EXPECT_FALSE(offered(smooth(true)));
}

}  // namespace
}  // namespace wheeltap::inference
