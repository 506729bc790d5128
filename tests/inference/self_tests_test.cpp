// Self-tests of user-defined priors and moves: correct ones pass, and each fault is found and
// reported.
#include "inference/moves/self_tests.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

#include "base/constants.hpp"
#include "inference/model/tabulated_prior.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

// F = 1/(1 + e^-x), with optional faults.
struct Faults {
  double mass = 1.0;       // factor of the density
  double stretch = 1.0;    // scale of the density's x
  double shift = 0.0;      // shift of the quantile
  bool turned = false;     // the quantile decreases
  bool undefined = false;  // the density is not a number
};
class Logistic : public Distribution {
 public:
  explicit Logistic(Faults faults = {}) : faults_(faults) {}
  [[nodiscard]] double log_density(double x) const override {
    if (faults_.undefined) return std::numeric_limits<double>::quiet_NaN();
    const double u = std::fabs(x) * faults_.stretch;
    return -u - 2.0 * std::log1p(std::exp(-u)) + std::log(faults_.stretch * faults_.mass);
  }
  [[nodiscard]] Tails tails(double x) const override {
    return {1.0 / (1.0 + std::exp(-x)), 1.0 / (1.0 + std::exp(x))};
  }
  [[nodiscard]] double quantile(Tails t) const override {
    const double x = std::log(t.below / t.above) + faults_.shift;
    return faults_.turned ? -x : x;
  }
  [[nodiscard]] double lower() const override { return -kInfinity; }
  [[nodiscard]] double upper() const override { return kInfinity; }
  [[nodiscard]] std::string describe() const override { return "logistic"; }

 private:
  Faults faults_;
};

PriorCheck checked(Faults faults) {
  return check_prior(OwnPrior{std::make_shared<Logistic>(faults)});
}

TEST(CheckPrior, PassesCorrectPriors) {
  const PriorCheck own = checked({});
  EXPECT_TRUE(own.passed()) << (own.passed() ? "" : own.faults.front());
  EXPECT_NEAR(own.mass, 1.0, 1e-6);
  for (const Prior& prior :
       {Prior(Uniform{1e9, 1e9 + 1.0}), Prior(StudentT{1.0, 0.0, 1.0}),
        Prior(InverseGamma{0.5, 2.0}), Prior(InverseGamma{1e-3, 1e-3}),
        Prior(StudentT{0.05, 0.5, 1.0}), Prior(Gamma{0.4, 2.0}),
        Prior(TruncatedNormal{0.0, 1.0, 40.0, 41.0}),
        Prior(OwnPrior{std::make_shared<TabulatedPrior>(std::vector<double>{0.0, 1.0, 3.0},
                                                        std::vector<double>{0.0, 2.0, 1.0})})}) {
    const PriorCheck check = check_prior(prior);
    EXPECT_TRUE(check.passed()) << prior.describe() << ": " << check.faults.front();
  }
}

TEST(CheckPrior, NamesEachFault) {
  const auto fault = [](Faults faults) {
    const PriorCheck check = checked(faults);
    return check.passed() ? std::string() : check.faults.front();
  };
  EXPECT_EQ(fault({.mass = 2.0}), "the density integrates to 2: it must be normalised");
  EXPECT_NE(fault({.stretch = 1.5}).find("times the derivative of the distribution function"),
            std::string::npos);
  EXPECT_NE(fault({.shift = 0.01}).find("the distribution function at this x gives z = "),
            std::string::npos);
  EXPECT_NE(fault({.turned = true}).find("the distribution function at this x gives z = "),
            std::string::npos);
  EXPECT_NE(fault({.undefined = true}).find("not a number"), std::string::npos);
}

// Nothing, a velocity, or a velocity and a weight; a reading of both.
class Reading : public Likelihood {
 public:
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    const double v = x.empty() ? 0.0 : std::fabs(x[0]), w = x.size() > 1 ? x[1] : 0.0;
    const double a = (0.6 - v - w) / 0.1, b = (1.0 + 0.5 * w - v * v) / 0.5;
    return -0.5 * (a * a + b * b);
  }
};

Problem problem() {
  return {.space = ModelSpace::of_models(
              {{"v", Normal{0.0, 1.0}}, {"w", Uniform{0.0, 1.0}}},
              {{"still", 0.5, {}}, {"moving", 0.3, {"v"}}, {"both", 0.2, {"v", "w"}}}),
          .likelihood = [] { return std::make_unique<Reading>(); }};
}

// z → e^u z of the first coordinate, u ~ N(0, ½²): the Jacobian is e^u.
class Stretch : public Move {
 public:
  explicit Stretch(double jacobian) : jacobian_(jacobian) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    if (from.z.empty()) return std::nullopt;
    const double u = 0.5 * step.random.normal();
    to.z[0] = from.z[0] * std::exp(u);
    return jacobian_ * u;
  }

 private:
  double jacobian_;
};

// A birth of the first parameter from N(½, 1), or its death. Models 0 and 1 have one such move;
// another move leads from 1 to 2.
class Appear : public Move {
 public:
  explicit Appear(double share) : share_(share) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    const auto log_q = [](double z) { return -0.5 * (z - 0.5) * (z - 0.5) - kLogSqrt2Pi; };
    if (from.model == 0) {
      to.model = 1;
      to.z = {0.5 + step.random.normal()};
      return -share_ * log_q(to.z[0]);
    }
    if (from.model == 1) {
      to.model = 0;
      to.z.clear();
      return share_ * log_q(from.z[0]);
    }
    return std::nullopt;
  }

 private:
  double share_;
};

// A typical error at the bounds: from 1 it goes up or down with equal probability, from 0 always
// up, and the ratio omits this.
class OmitsTheBounds : public Move {
 public:
  explicit OmitsTheBounds(bool knows) : knows_(knows) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    const auto log_q = [](double z) { return -0.5 * z * z - kLogSqrt2Pi; };
    const double half = knows_ ? std::log(2.0) : 0.0;
    const bool up = from.model == 0 || (from.model == 1 && step.random.uniform() < 0.5);
    to.model = from.model + (up ? 1 : -1);
    if (up) {
      to.z.push_back(step.random.normal());
      const double ends = from.model == 0 ? -half : half;
      return ends - log_q(to.z.back());
    }
    to.z.pop_back();
    return (from.model == 1 ? half : -half) + log_q(from.z.back());
  }

 private:
  bool knows_;
};

template <class M, class... A>
MoveCheck checked_move(A... arguments) {
  return check_move(problem(), [=] { return std::make_unique<M>(arguments...); });
}

TEST(CheckMove, PassesReversibleMoves) {
  for (const MoveCheck& check : {checked_move<Stretch>(1.0), checked_move<Appear>(1.0),
                                 checked_move<OmitsTheBounds>(true)}) {
    EXPECT_TRUE(check.passed) << check.words;
    EXPECT_GT(check.accepted, 500) << check.words;
    EXPECT_GT(check.beta, 0.0);
    EXPECT_NE(check.words.find("no fault found"), std::string::npos) << check.words;
  }
}

TEST(CheckMove, FindsIrreversibleMoves) {
  for (const MoveCheck& check :
       {checked_move<Stretch>(0.0), checked_move<Stretch>(2.0), checked_move<Appear>(0.0),
        checked_move<Appear>(0.8), checked_move<OmitsTheBounds>(false)}) {
    EXPECT_FALSE(check.passed) << check.words;
    EXPECT_NE(check.words.find("detailed balance is VIOLATED"), std::string::npos) << check.words;
  }
}

// A move without a reverse: always to the right.
class Rightwards : public Move {
 public:
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    if (from.z.empty()) return std::nullopt;
    to.z[0] += std::fabs(step.random.normal());
    return 0.0;
  }
};
class Never : public Move {
 public:
  explicit Never(bool proposes) : proposes_(proposes) {}
  std::optional<double> propose(const State&, const Step&, State&) override {
    if (!proposes_) return std::nullopt;
    return -kInfinity;
  }

 private:
  bool proposes_;
};

TEST(CheckMove, FindsAMissingReverseMove) {
  EXPECT_FALSE(checked_move<Rightwards>().passed);
}

TEST(CheckMove, ReportsMovesThatItCannotTest) {
  EXPECT_EQ(checked_move<Never>(false).words,
            "the move made no proposal from any draw of the prior");
  EXPECT_NE(checked_move<Never>(true).words.find("could not be tested"), std::string::npos);
  EXPECT_THROW(
      (void)check_move(problem(), [] { return std::make_unique<Rightwards>(); }, {.draws = 10}),
      std::invalid_argument);
}

// The prior factor is part of the target: with it, a correct move stays correct.
TEST(CheckMove, IncludesThePriorFactor) {
  Problem with = problem();
  with.log_prior_factor = [](int model, std::span<const double> x) {
    return model == 0 ? 0.0 : std::log(2.0) - (x[0] > 0.0 ? 0.0 : kInfinity);
  };
  const MoveCheck right = check_move(with, [] { return std::make_unique<Stretch>(1.0); });
  EXPECT_TRUE(right.passed) << right.words;
  EXPECT_FALSE(check_move(with, [] { return std::make_unique<Stretch>(0.5); }).passed);
}

}  // namespace
}  // namespace wheeltap::inference
