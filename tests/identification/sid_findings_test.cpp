#include "identification/sid/findings/sid_findings.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

inference::Options short_run() {
  inference::Options engine;
  engine.chains = 2;
  engine.warmup = 1000;
  engine.draws = 1000;
  return engine;
}

template <class Kind>
const Kind* find(const SidFindings& findings) {
  for (const Remark& remark : findings.remarks) {
    if (const auto* kind = std::get_if<Kind>(&remark)) return kind;
  }
  return nullptr;
}

SidFindings found(const SidCase& c) {
  const SidRun run = run_sid(c, {.engine = short_run()});
  return sid_findings(run, predict(*run.problem, run.posterior));
}

TEST(SidFindings, ContainModelProbabilitiesAndFit) {
  const SidFindings f = found(simulated(small_sid_case()));
  EXPECT_GT(f.models[1].probability(), 0.99);
  ASSERT_TRUE(f.of_models[1].has_value());
  const SidModelFinding& duffing = *f.of_models[1];
  ASSERT_EQ(duffing.at_mean.size(), 1U);
  EXPECT_NEAR(duffing.at_mean[0].rmse, 0.05, 0.0125);  // sd of an sd: 5 % of it; five of them
  EXPECT_NEAR(duffing.at_mean[0].r2, 1.0 - std::pow(duffing.at_mean[0].nrmse, 2), 1e-12);
  ASSERT_TRUE(duffing.at_mean[0].whiteness.has_value());
  EXPECT_EQ(duffing.best_draw.size(), 2U);
  ASSERT_TRUE(duffing.links && duffing.links->size() == 1U);
  EXPECT_EQ(duffing.links->front().extension.size(), duffing.links->front().q50.size());
  // ω = √(k / m), ζ = c / (2 m ω), at the median k.
  ASSERT_EQ(duffing.modes.size(), 1U);
  const double omega = std::sqrt(f.models[1].find("k")->q50 / 0.5);
  EXPECT_NEAR(duffing.modes[0].frequency_hz.q50 * 2.0 * M_PI / omega, 1.0, 1e-3);
  EXPECT_NEAR(duffing.modes[0].damping_ratio.q50 / (0.1 / omega), 1.0, 1e-3);
  // 97 % of 200 samples, minus five standard deviations of a binomial.
  EXPECT_GT(f.coverage[0], 0.91);
  ASSERT_EQ(f.bayes_factors.size(), 1U);
  ASSERT_TRUE(f.bayes_factors[0].log.has_value());
  EXPECT_GT(*f.bayes_factors[0].log, 5.0);
  EXPECT_EQ(find<remark::NoiseMisstated>(f), nullptr);
}

TEST(SidFindings, ReportsModelsWithSimilarResidualsTogether) {
  SidCase c = simulated(small_sid_case());
  c.truth.reset();
  c.models[1] = c.models[0];
  c.models[1].name = "twin";
  c.models.push_back(c.models[0]);
  c.models[2].name = "triplet";
  for (SidModel& model : c.models) model.weight = 1.0 / 3.0;
  const SidFindings f = found(c);
  std::size_t told = 0, others = 0;
  for (const Remark& remark : f.remarks)
    if (const auto* coloured = std::get_if<remark::ColouredResiduals>(&remark)) {
      ++told;
      others += coloured->others.size();
    }
  EXPECT_EQ(told, 1U);
  EXPECT_GE(others, 1U);
}

TEST(SidFindings, ReportsMisstatedNoise) {
  SidCase c = small_sid_case();
  c.truth->noise = {0.1};
  const SidFindings f = found(simulated(c));
  const auto* remark = find<remark::NoiseMisstated>(f);
  ASSERT_NE(remark, nullptr);
  EXPECT_NEAR(remark->channels[0].factor, 2.0, 0.5);
  EXPECT_EQ(remark->channels[0].name, "displacement [m]");
}

TEST(SidFindings, ReportsAParameterAtABoundOfItsPrior) {
  SidCase c = small_sid_case();
  c.models.pop_back();
  c.truth->model = 0;
  c.parameters = {{"k", inference::Uniform{0.0, 45.0}}};  // the truth is 50, known to a percent
  c.truth->theta = {50.0};
  const SidFindings f = found(simulated(c));
  const auto* remark = find<remark::ParameterAtBound>(f);
  ASSERT_NE(remark, nullptr);
  EXPECT_EQ(remark->parameter, "k");
  EXPECT_TRUE(remark->upper);
}

// For a gap wider than the motion, the record gives only a lower bound; otherwise it gives the gap.
TEST(SidFindings, ReportsAStopBeyondTheMotion) {
  using dynamics::Coefficient;
  SidCase c = small_sid_case();
  c.models.pop_back();
  c.models[0].chain.links[0].laws = {dynamics::make_law<dynamics::laws::Contact>(
      {500.0, Coefficient::of_parameter(1)}, dynamics::Side::closing)};
  c.models[0].parameters = {0, 1};
  c.parameters[1] = {"gap", inference::Uniform{0.0, 20.0}};
  c.truth->model = 0;
  c.truth->theta = {50.0, 15.0};
  SidFindings f = found(simulated(c));
  const auto* remark = find<remark::StopNotReached>(f);
  ASSERT_NE(remark, nullptr);
  EXPECT_EQ(remark->law, "contact");
  EXPECT_FALSE(remark->opening);
  EXPECT_DOUBLE_EQ(remark->reach, -f.of_models[0]->links->front().extension.front());
  EXPECT_GE(remark->share, 0.9);
  const double reach = remark->reach;
  SidCase touched = c;
  touched.truth->theta = {50.0, 0.5 * reach};
  EXPECT_EQ(find<remark::StopNotReached>(found(simulated(touched))), nullptr);
  // A further record with larger excitation counts too.
  c.truth->theta = {50.0, 2.0 * reach};
  SidCase both = simulated(c);
  SidCase harder = c;
  harder.truth->excitations[0].signal = TrueExcitation::White{2500.0};
  both.further = {simulated(harder)};
  f = found(both);
  EXPECT_EQ(find<remark::StopNotReached>(f), nullptr);
  EXPECT_NEAR(f.models[0].find("gap")->q50, 2.0 * reach, 0.1 * reach);
}

// With a noise of 1e-5 of the response, the default Runge-Kutta steps are too long.
TEST(SidRun, RepeatsWithBetterStepsIfTheyWereTooLong) {
  SidCase c = small_sid_case();
  c.truth->noise = {2e-6};
  for (SidModel& model : c.models) model.noise = {2e-6};
  c.parameters[0].prior = inference::Normal{50.0, 0.01};
  c.parameters[1].prior = inference::Normal{1000.0, 0.5};
  c.models.erase(c.models.begin());
  c.truth->model = 0;
  c = simulated(c);
  int told = 0;
  const SidRun run = run_sid(c, {.engine = short_run(), .sample = {}, .repeat = [&](const auto& r) {
                                   ++told;
                                   EXPECT_TRUE(r.by_series);
                                 }});
  EXPECT_GE(told, 1);
  EXPECT_TRUE(run.refined.has_value());
  EXPECT_LT(step_error(*run.problem, run.posterior, 0).value_or(0.0), kLargestStepError);
  c.fixed_integration = true;
  const SidRun fixed = run_sid(c, {.engine = short_run()});
  EXPECT_FALSE(fixed.refined.has_value());
  EXPECT_GT(step_error(*fixed.problem, fixed.posterior, 0).value_or(0.0), kLargestStepError);
  EXPECT_NE(
      find<remark::StepsTooLong>(sid_findings(fixed, predict(*fixed.problem, fixed.posterior))),
      nullptr);
}

// With a noise of 1e-9 of the response, the default series steps are too long as well; this is
// found before a run is repeated with them.
TEST(SidRun, TestsBetterStepsOnTheBestDraw) {
  SidCase c = small_sid_case();
  c.truth->noise = {1e-10};
  for (SidModel& model : c.models) model.noise = {1e-10};
  c.parameters[0].prior = inference::Normal{50.0, 1e-7};
  c.parameters[1].prior = inference::Normal{1000.0, 1e-5};
  c.models.erase(c.models.begin());
  c.truth->model = 0;
  c.fixed_integration = true;
  c = simulated(c);
  const SidRun run = run_sid(c, {.engine = short_run()});
  const auto better = better_integration(*run.problem, run.posterior);
  ASSERT_TRUE(better.has_value());
  EXPECT_TRUE(better->prefer_series);
  const auto error_with = [&](double step_limit) {
    c.integration = *better;
    c.integration.step_limit = step_limit;
    return step_error(*make_sid_problem(c), run.posterior, 0).value_or(0.0);
  };
  EXPECT_LE(error_with(better->step_limit), kLargestStepError);
  EXPECT_GT(error_with(dynamics::SimulatorOptions{}.step_limit), kLargestStepError);
}

// Replicates contain noise, so their median is jagged by a hundredth of it and has a noise floor in
// every spectrum; the motion without noise is smooth.
TEST(SidPredictive, TheMedianWithoutNoiseIsAsSmoothAsTheMotion) {
  const SidCase c = simulated(small_sid_case());
  const SidRun run = run_sid(c, {.engine = short_run()});
  const SidPredictive predictive = predict(*run.problem, run.posterior);
  const auto found = noise_free(*run.problem, run.posterior, predictive);
  ASSERT_EQ(found.size(), 1U);
  SidCase still = small_sid_case();
  still.truth->noise = {0.0};
  still = simulated(still);
  const std::vector<double>& truth = still.responses()[0]->signal.samples;
  const std::vector<double>& median = found[0].q50;
  ASSERT_EQ(median.size(), truth.size());
  double error = 0.0, jagged = 0.0;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    error += std::pow(median[n] - truth[n], 2);
    EXPECT_LE(found[0].q2_5[n], median[n]);
    EXPECT_LE(median[n], found[0].q97_5[n]);
    if (n < 2) continue;
    const auto off = [&](std::size_t i) { return median[i] - truth[i]; };
    jagged += std::pow(off(n) - 2.0 * off(n - 1) + off(n - 2), 2);
  }
  const auto samples = static_cast<double>(truth.size());
  // Two parameters from 200 samples of noise 0.05 give 0.005; the bound is three times that. A
  // median of 200 replicates has a scatter of 1.25 · 0.05 / √200 = 0.0044, its second differences
  // √6 times as much.
  EXPECT_LT(std::sqrt(error / samples), 0.015);
  EXPECT_LT(std::sqrt(jagged / samples), 0.002);
}

TEST(SidRun, ChoosesTheEffortByTheRunTimeOfALikelihood) {
  inference::Options asked;
  EXPECT_EQ(affordable(asked, 1e-6).warmup, 0) << "the engine's default";
  const inference::Options slow = affordable(asked, 1.0);
  EXPECT_GT(slow.draws, 0);
  EXPECT_LT(slow.draws, affordable(asked, 1e-3).draws);
  asked.draws = 17;
  EXPECT_EQ(affordable(asked, 1.0).draws, 17);
}

}  // namespace
}  // namespace wheeltap::identification
