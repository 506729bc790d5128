#include "inference/moves/newton_walk.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/inference/statistics.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kNoise = 0.2;

// One measurement of a_2 - a_1² with noise of sd 0.2: the posterior lies along a parabola.
class Parabola : public Likelihood {
 public:
  explicit Parabola(double measured) : measured_(measured) {}
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    const double r = residual(x);
    return -0.5 * r * r;
  }
  bool gauss_newton(int /*model*/, std::span<const double> x, std::span<const double> steps,
                    std::span<double> gradient, std::span<double> information) override {
    const double slope[] = {-2.0 * x[0] / kNoise * steps[0], steps[1] / kNoise};
    for (std::size_t i = 0; i < 2; ++i) {
      gradient[i] = -residual(x) * slope[i];
      for (std::size_t j = 0; j < 2; ++j) information[2 * i + j] = slope[i] * slope[j];
    }
    return true;
  }
  [[nodiscard]] bool has_exact_derivatives() const override { return true; }

 private:
  [[nodiscard]] double residual(std::span<const double> x) const {
    return (x[1] - x[0] * x[0] - measured_) / kNoise;
  }
  double measured_;
};

Problem parabola(double measured) {
  return {.space = ModelSpace::of_models({{"a1", Normal{0.0, 1.0}}, {"a2", Normal{0.0, 1.0}}},
                                         {{"parabola", 1.0, {"a1", "a2"}}}),
          .likelihood = [=] { return std::make_unique<Parabola>(measured); }};
}

class WithoutRatio : public NewtonWalk {
 public:
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    return NewtonWalk::propose(from, step, to) ? std::optional(0.0) : std::nullopt;
  }
};

struct Joint {
  std::vector<double> first, second;
  double accepted = 0.0;
};

// Parameters from the prior, a measurement given these parameters, and `steps` steps of the walk
// given the measurement. The parameters afterwards have the prior distribution again (Geweke 2004).
template <typename Walk>
Joint joint_draws(int steps, std::uint64_t stream) {
  constexpr int kDraws = 3000;
  Joint out;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    base::Random random(17, stream, i, base::Purpose::test);
    State state;
    state.z = {random.normal(), random.normal()};
    const Problem problem =
        parabola(state.z[1] - state.z[0] * state.z[0] + kNoise * random.normal());
    Target target(problem, false);
    target.evaluate(state);
    MetropolisHastings kernel("walk", std::make_unique<Walk>());
    for (int step = 0; step < steps; ++step)
      out.accepted += kernel.step(state, {target, random, 1.0, false}).accepted ? 1.0 : 0.0;
    out.first.push_back(state.z[0]);
    out.second.push_back(state.z[1]);
  }
  out.accepted /= std::max(1, steps) * kDraws;
  return out;
}

TEST(NewtonWalk, LeavesThePosteriorInvariant) {
  const Joint before = joint_draws<NewtonWalk>(0, 1), after = joint_draws<NewtonWalk>(10, 2);
  EXPECT_GT(two_sample_p_value(before.first, after.first), 1e-4);
  EXPECT_GT(two_sample_p_value(before.second, after.second), 1e-4);
  EXPECT_GT(after.accepted, 0.3);
  const Joint wrong = joint_draws<WithoutRatio>(10, 2);
  EXPECT_LT(std::min(two_sample_p_value(before.first, wrong.first),
                     two_sample_p_value(before.second, wrong.second)),
            1e-6);
}

TEST(NewtonWalk, NeedsExactDerivatives) {
  class Differences : public Parabola {
   public:
    Differences() : Parabola(0.0) {}
    [[nodiscard]] bool has_exact_derivatives() const override { return false; }
  };
  Problem problem = parabola(0.0);
  problem.likelihood = [] { return std::make_unique<Differences>(); };
  Target target(problem, false);
  State state, to;
  state.z = {0.1, 0.2};
  target.evaluate(state);
  to = state;
  base::Random random(17, 3, 0, base::Purpose::test);
  EXPECT_FALSE(NewtonWalk().propose(state, {target, random, 1.0, false}, to));
}

}  // namespace
}  // namespace wheeltap::inference
