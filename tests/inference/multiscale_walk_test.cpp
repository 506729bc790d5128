#include "inference/moves/multiscale_walk.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "inference/diagnosis/convergence.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kWidth = 10;

// Neal's funnel: v ~ N(0, 3²), x_i ~ N(0, e^v), nine of them, in coordinates v = 3 z_0, x = 20 z.
Problem funnel_target() {
  std::vector<std::string> names{"v"};
  std::vector<Parameter> unknowns{{"v", Normal{0.0, 3.0}}};
  for (int i = 1; i < kWidth; ++i) unknowns.push_back({"x" + std::to_string(i), Normal{0.0, 20.0}});
  for (int i = 1; i < kWidth; ++i) names.push_back("x" + std::to_string(i));
  return {.space = ModelSpace::of_models(unknowns, {{"funnel", 1.0, names}}), .likelihood = [] {
            return std::make_unique<FunctionLikelihood>([](int, std::span<const double> x) {
              double sum = 0.0;
              for (std::size_t i = 1; i < x.size(); ++i)
                sum += -0.5 * x[0] - 0.5 * x[i] * x[i] * (std::exp(-x[0]) - 1.0 / 400.0);
              return sum;
            });
          }};
}

// P(v < -3), from chains that start in the mouth.
struct Share {
  double value, error;
};
template <typename Walk>
Share in_the_neck() {
  const Problem problem = funnel_target();
  RandomWalk::Scales scales = RandomWalk::initial_scales(problem.space);
  // The posterior's standard deviations: the prior's for v, e^(9/4) = 9.5 for x.
  Eigen::MatrixXd& factor = scales[0].back().factor;
  factor.diagonal().setConstant(9.49 / 20.0);
  factor(0, 0) = 1.0;
  factor *= 2.38 / std::sqrt(static_cast<double>(kWidth));
  ChainsOf in_neck;
  for (std::uint64_t c = 0; c < 4; ++c) {
    Target target(problem, false);
    State state;
    state.model = 0;
    state.z.assign(kWidth, 0.05);
    target.evaluate(state);
    MetropolisHastings kernel("walk", std::make_unique<Walk>(scales));
    std::vector<double>& of = in_neck.emplace_back();
    for (std::uint64_t i = 0; i < 1'000'000; ++i) {
      base::Random random(3, c, i, base::Purpose::test);
      kernel.step(state, {target, random, 1.0, false});
      if (i % 100 == 0) of.push_back(state.x[0] < -3.0 ? 1.0 : 0.0);
    }
  }
  return {mean(in_neck), mcse_mean(in_neck)};
}

TEST(MultiscaleWalk, VisitsTheNeckOfAFunnelInProportion) {
  const double exact = 0.5 * std::erfc(1.0 / std::sqrt(2.0));  // of v ~ N(0, 3²)
  const Share all = in_the_neck<MultiscaleWalk>();
  EXPECT_NEAR(all.value, exact, 4.0 * all.error);
  EXPECT_LT(all.error, 0.2 * exact);
  // A walk with one scale, or a tenth and four times it, hardly reaches the neck.
  const Share few = in_the_neck<RandomWalk>();
  EXPECT_LT(few.value, 0.3 * exact);
}

}  // namespace
}  // namespace wheeltap::inference
