#include "inference/moves/regional_walk.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "inference/moves/random_walk.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kThin = 1e-4;

// A curved ridge: a ~ N(0, 1), b ~ N(a²/2, kThin²), in coordinates a and b.
Problem ridge() {
  return {.space = ModelSpace::of_models({{"a", Normal{0.0, 1.0}}, {"b", Normal{0.0, 1.0}}},
                                         {{"ridge", 1.0, {"a", "b"}}}),
          .likelihood = [] {
            return std::make_unique<FunctionLikelihood>([](int, std::span<const double> x) {
              const double off = (x[1] - 0.5 * x[0] * x[0]) / kThin;
              return -0.5 * off * off + 0.5 * x[1] * x[1];
            });
          }};
}

// Tangents at a = -3, -2.98 … 3, each as long as it stays on the ridge.
std::shared_ptr<const PilotFit> tangents() {
  constexpr double kAlong = 0.02;
  std::vector<NormalMixture::Component> components;
  for (int k = -100; k <= 100; ++k) {
    const double a = 0.03 * k;
    NormalMixture::Component c{1.0, Eigen::Vector2d(a, 0.5 * a * a), Eigen::Matrix2d::Zero()};
    c.factor << kAlong, 0.0, a * kAlong, kThin;
    components.push_back(std::move(c));
  }
  auto fit = std::make_shared<PilotFit>();
  fit->weight = {1.0};
  fit->density.push_back(std::make_unique<NormalMixture>(std::move(components)));
  return fit;
}

// Acceptance of 20 000 steps from the middle, and their root-mean-square distance.
struct WalkResult {
  double acceptance, distance;
};
WalkResult walk(std::unique_ptr<Move> move) {
  const Problem problem = ridge();
  Target target(problem, false);
  State state;
  state.model = 0;
  state.z = {0.0, 0.0};
  target.evaluate(state);
  MetropolisHastings kernel("walk", std::move(move));
  constexpr int kSteps = 20'000, kFar = 1000;
  int accepted = 0;
  double square = 0.0, before = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    base::Random random(5, 0, static_cast<std::uint64_t>(i), base::Purpose::test);
    accepted += kernel.step(state, {target, random, 1.0, false}).accepted ? 1 : 0;
    EXPECT_NEAR(state.x[1], 0.5 * state.x[0] * state.x[0], 8.0 * kThin);
    if (i % kFar != 0) continue;
    square += (state.x[0] - before) * (state.x[0] - before) * kFar / kSteps;
    before = state.x[0];
  }
  return {static_cast<double>(accepted) / kSteps, std::sqrt(square)};
}

TEST(RegionalWalk, FollowsACurvedRidge) {
  const WalkResult regional = walk(std::make_unique<RegionalWalk>(tangents()));
  EXPECT_GT(regional.acceptance, 0.3);
  EXPECT_GT(regional.distance, 0.1);
  // Almost no step with the covariance of the whole ridge is accepted.
  RandomWalk::Scales scales = RandomWalk::initial_scales(ridge().space);
  scales[0].back().factor << 1.0, 0.0, 0.0, std::sqrt(0.5);
  const WalkResult random = walk(std::make_unique<RandomWalk>(scales));
  EXPECT_LT(random.acceptance, 0.01);
  EXPECT_LT(random.distance, 0.5 * regional.distance);
}

class OmitsRatio : public RegionalWalk {
 public:
  using RegionalWalk::RegionalWalk;
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    if (!RegionalWalk::propose(from, step, to)) return std::nullopt;
    return 0.0;
  }
};

// For N(0, 1), the share within ±0.2; the boundary between two different components lies there.
template <typename Walk>
double errors_in_the_middle() {
  const Problem problem = {
      .space = ModelSpace::of_models({{"a", Normal{0.0, 1.0}}}, {{"prior", 1.0, {"a"}}}),
      .likelihood = [] {
        return std::make_unique<FunctionLikelihood>(
            [](int, std::span<const double>) { return 0.0; });
      }};
  const auto of = [](double sd) {
    return NormalMixture::Component{0.5, Eigen::VectorXd::Zero(1),
                                    sd * Eigen::MatrixXd::Identity(1, 1)};
  };
  auto fit = std::make_shared<PilotFit>();
  fit->weight = {1.0};
  fit->density.push_back(
      std::make_unique<NormalMixture>(std::vector<NormalMixture::Component>{of(0.05), of(1.0)}));
  ChainsOf within;
  for (std::uint64_t c = 0; c < 4; ++c) {
    Target target(problem, false);
    State state;
    state.model = 0;
    state.z = {0.0};
    target.evaluate(state);
    MetropolisHastings kernel("walk", std::make_unique<Walk>(fit));
    std::vector<double>& chain = within.emplace_back();
    for (std::uint64_t i = 0; i < 100'000; ++i) {
      base::Random random(6, c, i, base::Purpose::test);
      kernel.step(state, {target, random, 1.0, false});
      chain.push_back(std::fabs(state.z[0]) < 0.2 ? 1.0 : 0.0);
    }
  }
  return std::fabs(mean(within) - std::erf(0.2 / std::sqrt(2.0))) / mcse_mean(within);
}

TEST(RegionalWalk, LeavesTheTargetInvariant) {
  EXPECT_LT(errors_in_the_middle<RegionalWalk>(), 4.5);
  EXPECT_GT(errors_in_the_middle<OmitsRatio>(), 9.0);
}

}  // namespace
}  // namespace wheeltap::inference
