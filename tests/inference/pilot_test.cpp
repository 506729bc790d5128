#include "inference/chains/pilot.hpp"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <cmath>
#include <set>
#include <string>

#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

ModelSpace two_models() {
  return ModelSpace::of_models({{"a", Normal{0.0, 1.0}}, {"b", Normal{0.0, 1.0}}},
                               {{"none", 1.0, {}}, {"one", 1.0, {"a"}}, {"both", 1.0, {"a", "b"}}});
}

State state_of(int model, std::vector<double> z) {
  State state;
  state.model = model;
  state.z = std::move(z);
  return state;
}

TEST(PilotSamples, CountAllVisitsAndStoreThinnedStates) {
  const ModelSpace space = two_models();
  PilotSamples samples(space);
  constexpr int kVisits = 100000;
  for (int i = 0; i < kVisits; ++i) samples.add(state_of(1, {static_cast<double>(i)}));
  samples.add(state_of(0, {}));
  EXPECT_EQ(samples.visits(1), kVisits);
  EXPECT_EQ(samples.visits(0), 1);
  EXPECT_EQ(samples.visits(2), 0);
  EXPECT_EQ(samples.total(), kVisits + 1);
  const Eigen::MatrixXd kept = samples.states(1);
  EXPECT_EQ(kept.rows(), 1);
  EXPECT_GE(kept.cols(), 4000);
  EXPECT_LT(kept.cols(), 8000);
  // Equally spaced over the whole run.
  const double stride = kept(0, 1) - kept(0, 0);
  for (Eigen::Index i = 1; i < kept.cols(); ++i) EXPECT_EQ(kept(0, i) - kept(0, i - 1), stride);
  EXPECT_EQ(kept(0, 0), 0.0);
  EXPECT_GT(kept(0, kept.cols() - 1), kVisits - 2.0 * stride);
  EXPECT_EQ(samples.states(0).size(), 0);
}

TEST(PilotSamples, PoolSeveralChains) {
  const ModelSpace space = two_models();
  PilotSamples one(space), other(space);
  one.add(state_of(2, {1.0, 2.0}));
  other.add(state_of(2, {3.0, 4.0}));
  other.add(state_of(1, {5.0}));
  one.append(other);
  EXPECT_EQ(one.visits(2), 2);
  EXPECT_EQ(one.total(), 3);
  EXPECT_EQ(one.states(2), (Eigen::MatrixXd(2, 2) << 1, 3, 2, 4).finished());
  EXPECT_EQ(one.states(1)(0, 0), 5.0);
}

// N(2, 0.1²) in model 1; too few samples in model 2, which keeps its prior.
std::vector<PilotSamples> met(const ModelSpace& space) {
  PilotSamples samples(space);
  base::Random random(1, 0, 0, base::Purpose::test);
  for (int i = 0; i < 3000; ++i) samples.add(state_of(1, {2.0 + 0.1 * random.normal()}));
  for (int i = 0; i < 3; ++i) samples.add(state_of(2, {5.0, 5.0}));
  return {samples};
}

double log_normal_density(double z, double mean, double sd) {
  return -0.5 * std::pow((z - mean) / sd, 2.0) - std::log(sd) - 0.91893853320467274178;
}

TEST(FitPilot, FitsTheSamplesOrThePriorIfTheyAreFew) {
  const ModelSpace space = two_models();
  const Pilot pilot = fit_pilot(space, met(space), {});
  EXPECT_EQ(pilot.fit->density[0], nullptr);
  // 3000 draws give a mean to 2 % of the sd and ln sd to 1.3 %: 0.1 in ln q within two sds.
  for (const double z : {1.8, 2.0, 2.2}) {
    EXPECT_NEAR(pilot.fit->log_density(1, std::vector{z}), log_normal_density(z, 2.0, 0.1), 0.2)
        << z;
  }
  EXPECT_NEAR(pilot.fit->log_density(2, std::vector{0.5, -1.0}),
              log_normal_density(0.5, 0, 1) + log_normal_density(-1.0, 0, 1), 1e-9);
  // Models are weighted by their visits, with a positive lower limit.
  EXPECT_GT(pilot.fit->weight[1], 0.95);
  EXPECT_GE(pilot.fit->weight[0], 0.003);
  EXPECT_NEAR(pilot.fit->weight[0] + pilot.fit->weight[1] + pilot.fit->weight[2], 1.0, 1e-12);
}

TEST(FitPilot, UsesKnownProbabilities) {
  const ModelSpace space = two_models();
  const Pilot pilot = fit_pilot(space, met(space), {.probability = {0.2, 0.3, 0.5}});
  EXPECT_NEAR(pilot.fit->weight[0], 0.2, 1e-12);
  EXPECT_NEAR(pilot.fit->weight[2], 0.5, 1e-12);
}

// The proposal covers a mode that no chain visited.
TEST(FitPilot, CoversAModeOfTheSearches) {
  const ModelSpace space = two_models();
  const auto one = [](double mean) {
    return std::vector<NormalMixture::Component>{
        {0.5, Eigen::VectorXd::Constant(1, mean), Eigen::MatrixXd::Constant(1, 1, 0.05)}};
  };
  const std::vector<double> top{-3.0};
  const Pilot without = fit_pilot(space, met(space), {});
  const Pilot with = fit_pilot(space, met(space), {.modes = {{}, one(-3.0), {}}});
  EXPECT_LT(without.fit->log_density(1, top), log_normal_density(0.0, 0.0, 0.05) - 5.0);
  EXPECT_GT(with.fit->log_density(1, top), log_normal_density(0.0, 0.0, 0.05) + std::log(0.04));
}

TEST(FitPilot, UsesWarmerSamplesIfColdOnesAreMissing) {
  const ModelSpace space = two_models();
  PilotSamples warm(space), cold(space);
  base::Random random(2, 0, 0, base::Purpose::test);
  for (int i = 0; i < 500; ++i) warm.add(state_of(1, {-1.0 + 0.3 * random.normal()}));
  cold.add(state_of(0, {}));
  const Pilot pilot = fit_pilot(space, {warm, cold}, {});
  EXPECT_NEAR(pilot.fit->log_density(1, std::vector{-1.0}), log_normal_density(0.0, 0.0, 0.3), 0.4);
}

TEST(EqualVisitsBias, MakesModelsEquallyProbableAboveTheLimit) {
  const std::vector<double> p{0.9, 0.1, 1e-3, 1e-9};
  const std::vector<double> bias = equal_visits_bias(p, 1e-3);
  for (std::size_t m = 0; m < 3; ++m) EXPECT_NEAR(p[m] * std::exp(bias[m]), 1.0, 1e-12);
  EXPECT_NEAR(p[3] * std::exp(bias[3]), 1e-6, 1e-18);
}

std::set<std::string> names(const KernelMixture& kernels) {
  std::set<std::string> out;
  for (int k = 0; k < kernels.size(); ++k) out.insert(kernels[k].name());
  return out;
}

TEST(SamplingKernels, AreTheAllowedMoves) {
  const Problem problem = toy::bump_problem(std::vector<double>(toy::kSensors, 1.0), {1, 1, 1});
  Options options;
  long calls = 0;
  const Atlases atlases = make_atlases(problem, options, calls);
  EXPECT_GT(calls, 0);
  const Pilot pilot = fit_pilot(problem.space, {PilotSamples(problem.space)}, {});
  const auto all = names(*sampling_kernels(problem, options, atlases, pilot));
  for (const char* name :
       {"random walk", "multiscale walk", "regional walk", "informed birth and death", "relocation",
        "mirror", "mixture jump", "pilot birth and death"})
    EXPECT_TRUE(all.contains(name)) << name;
  options.moves = {.informed_birth = false,
                   .random_walk = false,
                   .relocation = false,
                   .reflection = false,
                   .independence = false};
  const auto few = names(*sampling_kernels(problem, options, atlases, pilot));
  EXPECT_EQ(few, (std::set<std::string>{"birth and death"}));
  EXPECT_EQ(names(*exploration_kernels(problem, options, atlases)), few);
}

}  // namespace
}  // namespace wheeltap::inference
