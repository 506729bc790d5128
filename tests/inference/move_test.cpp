// Every kernel leaves prior × likelihood^β invariant: the exact test of Gandy & Scott (2020,
// section 2). Parameters from the prior and data simulated from them are a draw of the joint
// distribution. They remain one after any number of steps of a kernel that leaves the posterior
// invariant, whether or not it mixes. Each test has a control: the same move with a fault, which
// the test must detect.
#include "inference/moves/move.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "inference/moves/between_models/birth_death.hpp"
#include "inference/moves/between_models/conditional_proposal.hpp"
#include "inference/moves/between_models/mixture_transport.hpp"
#include "inference/moves/between_models/model_switch.hpp"
#include "inference/moves/between_models/split_merge.hpp"
#include "inference/moves/between_models/transformation.hpp"
#include "inference/moves/delayed_rejection.hpp"
#include "inference/moves/differential_evolution.hpp"
#include "inference/moves/image.hpp"
#include "inference/moves/mirror.hpp"
#include "inference/moves/mixture_jump.hpp"
#include "inference/moves/multiscale_walk.hpp"
#include "inference/moves/random_walk.hpp"
#include "inference/moves/regional_walk.hpp"
#include "inference/moves/slice.hpp"
#include "tests/inference/statistics.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

// Probability that a correct kernel fails: six functionals, two test models.
constexpr double kFalseAlarm = 1e-6;
constexpr int kReplicates = 6000;
constexpr int kSteps = 7;  // odd, since two reflections cancel

using MoveFactory = std::function<std::unique_ptr<Move>()>;
using KernelFactory = std::function<std::unique_ptr<Kernel>()>;

KernelFactory accepted_or_rejected(const MoveFactory& make) {
  return [make] { return std::make_unique<MetropolisHastings>("under test", make()); };
}

// A move whose ratio is replaced by 1.
class OmitsRatio : public Move {
 public:
  explicit OmitsRatio(std::unique_ptr<Move> move) : move_(std::move(move)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    if (!move_->propose(from, step, to)) return std::nullopt;
    return 0.0;
  }

 private:
  std::unique_ptr<Move> move_;
};

// A move that is accepted whatever the target says.
class AlwaysAccepted : public Move {
 public:
  explicit AlwaysAccepted(std::unique_ptr<Move> move) : move_(std::move(move)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    if (!move_->propose(from, step, to)) return std::nullopt;
    return 1e6;
  }

 private:
  std::unique_ptr<Move> move_;
};

std::vector<double> functionals(const State& state) {
  double location = 0.0, height = 0.0, square = 0.0;
  for (std::size_t i = 0; i + 1 < state.x.size(); i += 2) {
    location += state.x[i];
    height += state.x[i + 1];
    square += state.x[i] * state.x[i + 1];
  }
  const double last = state.x.empty() ? 0.0 : state.x.back();
  return {location, height, square, last, state.log_likelihood};
}

struct Sample {
  std::vector<double> models;
  std::vector<std::vector<double>> values;  // [functional][replicate]
};

using ProblemFactory = Problem (*)(std::vector<double> data, const std::vector<double>& weights);

// (model, parameters) of kReplicates joint draws, after `steps` steps of the kernel.
Sample joint_draws(const std::vector<double>& weights, const KernelFactory& make, int steps,
                   int stream, double beta, ProblemFactory make_problem) {
  Sample sample{.models = std::vector<double>(weights.size(), 0.0), .values = {}};
  for (int n = 0; n < kReplicates; ++n) {
    base::Random random(7, static_cast<std::uint64_t>(stream), static_cast<std::uint64_t>(n),
                        base::Purpose::test);
    // A Gaussian likelihood tempered by β is one with its noise divided by √β.
    const Problem blind = toy::bump_problem(std::vector<double>(toy::kSensors, 0.0), weights);
    Target prior(blind, true);
    State state;
    prior.draw_prior(random, state);
    prior.evaluate(state);
    std::vector<double> data(toy::kSensors);
    toy::predict(state.x, data);
    for (double& y : data) y += toy::kNoise / std::sqrt(beta) * random.normal();
    const Problem problem = make_problem(data, weights);
    Target target(problem, false);
    target.evaluate(state);
    const auto kernel = make();
    for (int s = 0; s < steps; ++s) kernel->step(state, {target, random, beta, false});
    sample.models[static_cast<std::size_t>(state.model)] += 1.0;
    const auto values = functionals(state);
    sample.values.resize(values.size());
    for (std::size_t f = 0; f < values.size(); ++f) sample.values[f].push_back(values[f]);
  }
  return sample;
}

// The smallest p-value over the functionals, times their number (Bonferroni).
double kernel_p_value(const KernelFactory& make, const std::vector<double>& weights = {1, 2, 2, 1},
                      double beta = 1.0, ProblemFactory make_problem = toy::bump_problem) {
  const Sample before = joint_draws(weights, make, 0, 1, beta, make_problem);
  const Sample after = joint_draws(weights, make, kSteps, 2, beta, make_problem);
  double smallest = same_counts_p_value(before.models, after.models);
  for (std::size_t f = 0; f < before.values.size(); ++f) {
    smallest = std::min(smallest, two_sample_p_value(before.values[f], after.values[f]));
  }
  return std::min(1.0, smallest * static_cast<double>(before.values.size() + 1));
}

double invariance_p_value(const MoveFactory& make,
                          const std::vector<double>& weights = {1, 2, 2, 1}, double beta = 1.0) {
  return kernel_p_value(accepted_or_rejected(make), weights, beta);
}

template <typename Broken>
MoveFactory broken(const MoveFactory& make) {
  return [make] { return std::make_unique<Broken>(make()); };
}

std::shared_ptr<const EffectAtlas> toy_atlas() {
  static const auto atlas = [] {
    const Problem problem = toy::bump_problem(std::vector<double>(toy::kSensors, 0.0), {1, 1});
    Target target(problem, false);
    return make_atlas(target, 0);
  }();
  return atlas;
}

// Mixtures and archives leave the target invariant even if they fit badly.
std::shared_ptr<const PilotFit> rough_fit(const ModelSpace& space) {
  auto fit = std::make_shared<PilotFit>();
  for (int m = 0; m < space.size(); ++m) {
    fit->weight.push_back(0.1 + 0.2 * m);
    const int d = space[m].dimension;
    if (d == 0) {
      fit->density.push_back(nullptr);
      continue;
    }
    base::Random random(3, 0, static_cast<std::uint64_t>(m), base::Purpose::test);
    Eigen::MatrixXd samples(400, d);
    for (double& value : samples.reshaped()) value = 0.3 + 0.7 * random.normal();
    fit->density.push_back(std::make_unique<NormalMixture>(NormalMixture::fit(samples, random)));
  }
  double total = 0.0;
  for (const double w : fit->weight) total += w;
  for (double& w : fit->weight) w /= total;
  return fit;
}

std::shared_ptr<const Archive> rough_archive(const ModelSpace& space) {
  auto archive = std::make_shared<Archive>();
  base::Random random(4, 0, 0, base::Purpose::test);
  for (int m = 0; m < space.size(); ++m) {
    Eigen::MatrixXd& states = archive->emplace_back(space[m].dimension, 50);
    for (double& value : states.reshaped()) value = random.normal();
  }
  return archive;
}

MoveFactory birth_from_prior() {
  return [] { return std::make_unique<BirthDeath>(0, std::make_unique<PriorProposal>()); };
}

template <typename M>
MoveFactory informed() {
  return [] {
    static const ModelSpace space = toy::bump_space({1, 2, 2, 1});
    return std::make_unique<M>(0, std::make_unique<InformedProposal>(toy_atlas(), space, 0));
  };
}

TEST(Invariance, BirthAndDeathFromThePrior) {
  EXPECT_GT(invariance_p_value(birth_from_prior()), kFalseAlarm);
  EXPECT_GT(invariance_p_value(birth_from_prior(), {1, 2, 2, 1}, 0.3), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<OmitsRatio>(birth_from_prior())), kFalseAlarm);
}

TEST(Invariance, InformedBirthAndDeath) {
  ASSERT_NE(toy_atlas(), nullptr);
  EXPECT_GT(invariance_p_value(informed<BirthDeath>()), kFalseAlarm);
  EXPECT_GT(invariance_p_value(informed<BirthDeath>(), {1, 2, 2, 1}, 0.3), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<OmitsRatio>(informed<BirthDeath>())), kFalseAlarm);
}

TEST(Invariance, Relocation) {
  EXPECT_GT(invariance_p_value(informed<Relocation>()), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<OmitsRatio>(informed<Relocation>())), kFalseAlarm);
}

TEST(Invariance, RandomWalk) {
  const MoveFactory make = [] {
    return std::make_unique<RandomWalk>(RandomWalk::initial_scales(toy::bump_space({1, 2, 2, 1})));
  };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

TEST(Invariance, MultiscaleWalk) {
  const MoveFactory make = [] {
    return std::make_unique<MultiscaleWalk>(
        RandomWalk::initial_scales(toy::bump_space({1, 2, 2, 1})));
  };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

TEST(Invariance, RegionalWalk) {
  const auto fit = rough_fit(toy::bump_space({1, 2, 2, 1}));
  const MoveFactory make = [&] { return std::make_unique<RegionalWalk>(fit); };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_GT(invariance_p_value(make, {1, 2, 2, 1}, 0.3), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
  // Only long chains show a missing ratio: regional_walk_test.cpp.
}

TEST(Invariance, MirrorOfAll) {
  const MoveFactory make = [] {
    return std::make_unique<Mirror>(std::vector<Reflection>{{0, 0, 0.5}}, true);
  };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

TEST(Invariance, MirrorOfOne) {
  const MoveFactory make = [] {
    return std::make_unique<Mirror>(std::vector<Reflection>{{0, 0, 0.5}}, false);
  };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

// A rotation by a third and its inverse, which are different maps.
std::vector<Symmetry> thirds(double backwards) {
  std::vector<Symmetry> out;
  for (const double turn : {1.0 / 3.0, backwards})
    out.push_back({{{0, 0, [turn](double x) { return std::fmod(x + turn, 1.0); }}}});
  return out;
}

// A temperature at which rotations are accepted.
constexpr double kWarm = 1e-3;

TEST(Invariance, ImagesUnderARotation) {
  for (const bool whole : {true, false}) {
    const MoveFactory make = [whole] { return std::make_unique<Image>(thirds(2.0 / 3.0), whole); };
    EXPECT_GT(invariance_p_value(make, {1, 2, 2, 1}, kWarm), kFalseAlarm) << whole;
    EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make), {1, 2, 2, 1}, kWarm), kFalseAlarm)
        << whole;
  }
}

// Without the inverse rotation there is no reverse move.
TEST(Invariance, DetectsARotationWithoutItsInverse) {
  const MoveFactory make = [] { return std::make_unique<Image>(thirds(1.0 / 3.0), true); };
  EXPECT_LT(invariance_p_value(make, {1, 2, 2, 1}, kWarm), kFalseAlarm);
}

TEST(Invariance, DifferentialEvolution) {
  const auto archive = rough_archive(toy::bump_space({1, 2, 2, 1}));
  const MoveFactory make = [archive] { return std::make_unique<DifferentialEvolution>(archive); };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

// Two modes of width 1e-8 at a distance of 2, with weights of one and three quarters.
TEST(DifferentialEvolution, MovesWithinAndBetweenVeryNarrowModes) {
  constexpr double kWidth = 1e-8;
  class Needles : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      const auto square = [&](double centre) {
        const double u = (x[0] - centre) / kWidth, v = (x[1] - centre) / kWidth;
        return u * u + v * v;
      };
      const double left = std::log(0.25) - 0.5 * square(-1.0);
      const double right = std::log(0.75) - 0.5 * square(1.0);
      return std::max(left, right) + std::log1p(std::exp(-std::fabs(left - right)));
    }
  };
  const Problem problem{
      .space = ModelSpace::of_models({{"a", Normal{0.0, 1.0}}, {"b", Normal{0.0, 1.0}}},
                                     {{"only", 1.0, {"a", "b"}}}),
      .likelihood = [] { return std::make_unique<Needles>(); }};
  // The prior is flat over a mode.
  const auto draw = [](base::Random& random, std::span<double> z) {
    const double centre = random.uniform() < 0.25 ? -1.0 : 1.0;
    for (double& value : z) value = centre + kWidth * random.normal();
  };
  auto archive = std::make_shared<Archive>(1, Eigen::MatrixXd(2, 200));
  base::Random random(5, 0, 0, base::Purpose::test);
  for (Eigen::Index i = 0; i < 200; ++i) draw(random, std::span(archive->front().col(i).data(), 2));

  Target target(problem, false);
  int accepted = 0, crossed = 0;
  const auto run = [&](bool fault) {
    std::vector<double> before, after;
    accepted = crossed = 0;
    std::unique_ptr<Move> move = std::make_unique<DifferentialEvolution>(archive);
    if (fault) move = std::make_unique<AlwaysAccepted>(std::move(move));
    MetropolisHastings kernel("under test", std::move(move));
    // In units of the width, the left mode 100 from the right one.
    const auto place = [](double z) {
      return z < 0.0 ? (z + 1.0) / kWidth - 100.0 : (z - 1.0) / kWidth;
    };
    for (int n = 0; n < kReplicates; ++n) {
      State state;
      state.z.resize(2);
      draw(random, state.z);
      before.push_back(place(state.z[0]));
      draw(random, state.z);
      target.evaluate(state);
      for (int s = 0; s < kSteps; ++s) {
        const bool left = state.z[0] < 0.0;
        accepted += kernel.step(state, {target, random, 1.0, false}).accepted ? 1 : 0;
        crossed += (state.z[0] < 0.0) != left ? 1 : 0;
      }
      after.push_back(place(state.z[0]));
    }
    return two_sample_p_value(before, after);
  };
  EXPECT_GT(run(false), kFalseAlarm);
  const double steps = kReplicates * kSteps;
  std::printf("    accepted %.3f, crossed %.4f\n", accepted / steps, crossed / steps);
  EXPECT_GT(accepted / steps, 0.1);
  EXPECT_GT(crossed / steps, 0.002);
  EXPECT_LT(run(true), kFalseAlarm);
}

TEST(Invariance, MixtureJumpBetweenModels) {
  const auto fit = rough_fit(toy::bump_space({1, 2, 2, 1}));
  const MoveFactory make = [fit] { return std::make_unique<MixtureJump>(fit, true); };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<OmitsRatio>(make)), kFalseAlarm);
}

TEST(Invariance, MixtureRenewalWithinAModel) {
  const auto fit = rough_fit(toy::bump_space({1, 2, 2, 1}));
  const MoveFactory make = [fit] { return std::make_unique<MixtureJump>(fit, false); };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

TEST(Invariance, MixtureTransport) {
  const auto fit = rough_fit(toy::bump_space({1, 2, 2, 1}));
  const MoveFactory make = [fit] { return std::make_unique<MixtureTransport>(fit); };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<OmitsRatio>(make)), kFalseAlarm);
}

TEST(Invariance, SplitAndMerge) {
  for (const auto keeps : {SplitMerge::Keeps::sum, SplitMerge::Keeps::product_of_complements}) {
    const MoveFactory make = [keeps] { return std::make_unique<SplitMerge>(0, 0.15, keeps); };
    EXPECT_GT(invariance_p_value(make), kFalseAlarm);
    EXPECT_LT(invariance_p_value(broken<OmitsRatio>(make)), kFalseAlarm);
  }
}

// Births use the mixture of the larger model, deaths that of the smaller one.
TEST(Invariance, PilotBirthAndDeath) {
  static const ModelSpace space = toy::bump_space({1, 2, 2, 1});
  const auto fit = rough_fit(space);
  const auto mixtures = std::make_shared<const ConditionalMixtures>(space, *fit, 0);
  const auto birth = [=](std::unique_ptr<ComponentProposal> proposal) {
    return std::make_unique<BirthDeath>(0, std::move(proposal), fit);
  };
  const MoveFactory from_pilot = [=] {
    return birth(std::make_unique<ConditionalProposal>(mixtures, space, 0));
  };
  const MoveFactory from_prior = [=] { return birth(std::make_unique<PriorProposal>()); };
  for (const MoveFactory& make : {from_pilot, from_prior}) {
    EXPECT_GT(invariance_p_value(make), kFalseAlarm);
    EXPECT_GT(invariance_p_value(make, {1, 2, 2, 1}, 0.3), kFalseAlarm);
    EXPECT_LT(invariance_p_value(broken<OmitsRatio>(make)), kFalseAlarm);
  }
}

TEST(Invariance, PilotRelocation) {
  static const ModelSpace space = toy::bump_space({1, 2, 2, 1});
  const auto mixtures = std::make_shared<const ConditionalMixtures>(space, *rough_fit(space), 0);
  const MoveFactory make = [=] {
    return std::make_unique<Relocation>(0,
                                        std::make_unique<ConditionalProposal>(mixtures, space, 0));
  };
  EXPECT_GT(invariance_p_value(make), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<AlwaysAccepted>(make)), kFalseAlarm);
}

// One bump (x, a) ↔ two bumps (x u, a w), (x, a (1 - w)); an auxiliary v ↔ v² on the way, so that
// both sides have one:
//
//   ln |J| = ln x + ln a + ln 2v.
//
// The broken copy forgets it in both directions, which no round trip notices.
TEST(Invariance, Transformation) {
  const auto make = [](bool forgets_jacobian) -> MoveFactory {
    const double counts = forgets_jacobian ? 0.0 : 1.0;
    return [counts] {
      return std::make_unique<Transformation>(
          toy::bump_space({1, 2, 2, 1}),
          Transformation::Definition{
              .lower = 1,
              .upper = 2,
              .lower_auxiliaries = {Beta{2.0, 2.0}, Beta{2.0, 3.0}, Uniform{0.0, 1.0}},
              .upper_auxiliaries = {Beta{2.0, 3.0}},
              .forward =
                  [counts](std::span<const double> from, std::span<double> to) {
                    const double x = from[0], a = from[1], u = from[2], w = from[3], v = from[4];
                    to[0] = x * u;
                    to[1] = a * w;
                    to[2] = x;
                    to[3] = a * (1.0 - w);
                    to[4] = v * v;
                    return counts * std::log(2.0 * x * a * v);
                  },
              .inverse =
                  [counts](std::span<const double> from, std::span<double> to) {
                    const double x = from[2], a = from[1] + from[3], v = std::sqrt(from[4]);
                    to[0] = x;
                    to[1] = a;
                    to[2] = from[0] / x;
                    to[3] = from[1] / a;
                    to[4] = v;
                    return -counts * std::log(2.0 * x * a * v);
                  }});
    };
  };
  EXPECT_GT(invariance_p_value(make(false)), kFalseAlarm);
  EXPECT_GT(invariance_p_value(make(false), {1, 2, 2, 1}, 0.3), kFalseAlarm);
  EXPECT_LT(invariance_p_value(make(true)), kFalseAlarm);
  EXPECT_LT(invariance_p_value(broken<OmitsRatio>(make(false))), kFalseAlarm);
}

// Delayed acceptance, with and without moves that use residuals, hot and cold.
TEST(Invariance, DelayedAcceptance) {
  const std::vector<double> weights = {1, 2, 2, 1};
  const auto p_value = [&](const KernelFactory& make, double beta) {
    return kernel_p_value(make, weights, beta, toy::screened_bump_problem);
  };
  const MoveFactory walk = [] {
    return std::make_unique<RandomWalk>(RandomWalk::initial_scales(toy::bump_space({1, 2, 2, 1})));
  };
  for (const double beta : {1.0, 0.3}) {
    EXPECT_GT(p_value(accepted_or_rejected(informed<BirthDeath>()), beta), kFalseAlarm);
    EXPECT_GT(p_value(accepted_or_rejected(informed<Relocation>()), beta), kFalseAlarm);
    EXPECT_GT(p_value(accepted_or_rejected(walk), beta), kFalseAlarm);
  }
  // The control uses only the approximate likelihood.
  class ScreenOnly : public Kernel {
   public:
    explicit ScreenOnly(std::unique_ptr<Move> move)
        : Kernel("screen only"), move_(std::move(move)) {}
    Outcome step(State& state, const Step& s) override {
      State to = state;
      const auto log_hastings = move_->propose(state, s, to);
      if (!log_hastings) return {};
      s.target.evaluate(to);
      const double ratio = log_screen_ratio(s.target, s.beta, state, to) + *log_hastings;
      if (std::log(s.random.uniform()) < ratio) state = to;
      return {.proposed = true, .accepted = true, .to_model = state.model};
    }

   private:
    std::unique_ptr<Move> move_;
  };
  const auto control = [](const MoveFactory& make) -> KernelFactory {
    return [make] { return std::make_unique<ScreenOnly>(make()); };
  };
  EXPECT_LT(p_value(control(informed<BirthDeath>()), 1.0), kFalseAlarm);
  EXPECT_LT(p_value(control(walk), 1.0), kFalseAlarm);
}

TEST(DelayedAcceptance, EvaluatesTheLikelihoodOnlyAfterTheFirstStage) {
  const std::vector<double> data = {0.4, 0.3, -0.1, 0.2, 0.5, 0.0};
  const Problem problem = toy::screened_bump_problem(data, {1, 2, 2, 1});
  Target target(problem, false);
  base::Random random(1, 0, 0, base::Purpose::test);
  State state;
  target.draw_prior(3, random, state);
  target.screen(state);
  EXPECT_EQ(target.full_evaluations(), 0);
  EXPECT_EQ(state.log_likelihood, -std::numeric_limits<double>::infinity()) << "not known yet";
  target.complete(state);
  EXPECT_EQ(target.full_evaluations(), 1);
  EXPECT_EQ(state.log_likelihood, toy::BumpLikelihood(data).log_likelihood(state.model, state.x));
  EXPECT_EQ(state.log_screen, toy::BumpLikelihood(data, 0.7).log_likelihood(state.model, state.x));
  MetropolisHastings kernel("births", birth_from_prior()());
  const long before = target.full_evaluations();
  long passed = 0, accepted = 0;
  for (int i = 0; i < 1000; ++i) {
    const long full = target.full_evaluations();
    const State from = state;
    const auto outcome = kernel.step(state, {target, random, 1.0, false});
    passed += target.full_evaluations() - full;
    accepted += outcome.accepted ? 1 : 0;
    if (!outcome.accepted) {
      EXPECT_EQ(state.z, from.z);
    }
  }
  EXPECT_GT(passed, accepted);
  EXPECT_LT(target.full_evaluations() - before, 700) << "most proposals fail the screen";
}

TEST(Invariance, Slice) {
  EXPECT_GT(kernel_p_value([] { return std::make_unique<Slice>(1.0); }), kFalseAlarm);
  // The control uses half of the log likelihood.
  class HalfLikelihood : public Slice {
   public:
    using Slice::Slice;
    Outcome step(State& state, const Step& s) override {
      return Slice::step(state, {s.target, s.random, 0.5 * s.beta, false});
    }
  };
  EXPECT_LT(kernel_p_value([] { return std::make_unique<HalfLikelihood>(1.0); }), kFalseAlarm);
}

TEST(Invariance, DelayedRejection) {
  const auto scales = RandomWalk::initial_scales(toy::bump_space({1, 2, 2, 1}));
  EXPECT_GT(kernel_p_value([&] { return std::make_unique<DelayedRejection>(scales); }),
            kFalseAlarm);
  // The control omits the first stage from the ratio of the second: it accepts too few points
  // beyond a rejected one.
  class OmitsFirstStage : public Kernel {
   public:
    explicit OmitsFirstStage(RandomWalk::Scales scales)
        : Kernel("forgets"), walk_(scales), scales_(std::move(scales)) {}
    Outcome step(State& state, const Step& s) override {
      State to = state;
      if (!walk_.propose(state, s, to)) return {};
      s.target.evaluate(to);
      const double ratio = log_target_ratio(s.target, s.beta, state, to);
      if (std::log(s.random.uniform()) < ratio) {
        state = to;
      } else if (std::log(s.random.uniform()) < ratio + 1.0) {
        state = to;  // the rejected point gets a second chance
      }
      return {.proposed = true, .accepted = true, .to_model = state.model};
    }

   private:
    RandomWalk walk_;
    RandomWalk::Scales scales_;
  };
  EXPECT_LT(kernel_p_value([&] { return std::make_unique<OmitsFirstStage>(scales); }), kFalseAlarm);
}

// Kernels with additional cost are rated by accepted moves per work; cheap ones keep their weight.
TEST(KernelEfficiencies, DependOnWorkAndNotOnTime) {
  class Idle : public Kernel {
   public:
    Idle(const char* name, double work) : Kernel(name, work) {}
    Outcome step(State&, const Step&) override { return {}; }
  };
  KernelMixture kernels;
  kernels.add(1.0, std::make_unique<Idle>("cheap", 0.0));
  kernels.add(1.0, std::make_unique<Idle>("expensive and as often accepted", 3.0));
  kernels.add(1.0, std::make_unique<Idle>("expensive and hardly accepted", 3.0));
  kernels.add(1.0, std::make_unique<Idle>("cheap and hardly accepted", 0.0));
  kernels.add(1.0, std::make_unique<Idle>("expensive and hardly tried", 3.0));
  kernels.add(1.0, std::make_unique<Idle>("may grow", 1.0), 1.4);
  kernels.add(1.0, std::make_unique<Idle>("may grow further", 1.0), 5.0);
  const auto jumps = [](long proposed, long accepted) {
    return KernelRecord{proposed, accepted, proposed, accepted};
  };
  const std::vector<double> efficiency = kernel_efficiencies(
      kernels, {jumps(1000, 100), jumps(1000, 200), jumps(1000, 4), jumps(1000, 4), jumps(10, 0),
                jumps(1000, 400), jumps(1000, 300)});
  EXPECT_EQ(efficiency[0], 1.0);
  EXPECT_DOUBLE_EQ(efficiency[1], 0.25);  // .05 per unit of work, against .2
  EXPECT_DOUBLE_EQ(efficiency[2], 0.1);
  EXPECT_EQ(efficiency[3], 1.0);
  EXPECT_EQ(efficiency[4], 1.0);
  EXPECT_DOUBLE_EQ(efficiency[5], 0.2 / 0.15);
  EXPECT_DOUBLE_EQ(efficiency[6], 0.75);
}

}  // namespace
}  // namespace wheeltap::inference
