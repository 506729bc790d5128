#include "identification/findings/fit_verdict.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "identification/sid/findings/free_cubic.hpp"
#include "identification/sid/findings/sid_findings.hpp"
#include "identification/sid/sid_plausibility.hpp"
#include "identification/structural/damage/damage_plausibility.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "inference/diagnosis/convergence.hpp"
#include "tests/identification/cases.hpp"
#include "tests/identification/sid_cases.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;

template <class Kind, class List>
const Kind* find(const List& list) {
  for (const auto& entry : list) {
    if (const auto* kind = std::get_if<Kind>(&entry)) return kind;
  }
  return nullptr;
}

// The record of the truth's model, declared as measured; the true model is then removed from the
// candidates.
SidCase measured(SidCase c, const RecordUse& use = {}) {
  c.simulated = true;
  const signals::Record record = simulate_record(c, c.truth->seed);
  c.simulated = false;
  c.models.erase(c.models.begin() + c.truth->model);
  c.truth.reset();
  take_record(c, record, use);
  return c;
}

SidFindings found(const SidCase& c) {
  inference::Options engine;
  engine.chains = 2;
  engine.warmup = 1000;
  engine.draws = 500;
  const SidRun run = run_sid(c, {.engine = engine});
  return sid_findings(run, predict(*run.problem, run.posterior));
}

// A mass that slips on dry friction under a force of twice its size; the model has a dashpot.
SidCase friction() {
  SidCase c = small_sid_case();
  dynamics::Link slipping{.a = 0, .b = 1, .stiffness = 50.0, .damping = 0.0};
  const std::vector<Coefficient> friction = {5.0, 0.01};
  slipping.laws.push_back(dynamics::make_law("coulomb", friction));
  dynamics::Link viscous = slipping;
  viscous.laws.clear();
  viscous.damping = Coefficient::of_parameter(0);
  c.parameters = {{"c", inference::Uniform{0.0, 100.0}}};
  c.models[0].chain.links = {viscous};
  c.models[0].name = "viscous";
  c.models[1].chain.links = {slipping};
  c.models[0].noise = c.models[1].noise = {1e-4};
  c.models[1].parameters = {};
  c.truth->theta = {0.0};
  c.truth->noise = {1e-4};
  c.truth->samples = 400;
  return c;
}

TEST(FitVerdict, ADashpotDoesNotExplainFriction) {
  const SidFindings f = found(measured(friction()));
  EXPECT_FALSE(f.fit_verdict.ok());
  EXPECT_TRUE(find<misfit::NotNoise>(f.fit_verdict.why) != nullptr ||
              find<misfit::Unexplained>(f.fit_verdict.why) != nullptr);
}

TEST(FitVerdict, TheTrueModelExplainsItsRecordAndBeyond) {
  SidCase c = small_sid_case();
  c.truth->samples = 400;
  c.models.push_back(c.models[1]);
  c.models.back().name = "the same";
  const SidFindings f = found(measured(c, {.samples = {{0, 200}}}));
  EXPECT_EQ(f.fit_verdict.why.size(), 0U);
  EXPECT_GT(f.fit_verdict.p, 1e-3);
  EXPECT_LT(f.fit_verdict.p, 1.0 - 1e-3);
  EXPECT_GT(f.fit_verdict.r2, 0.8);
}

// A stop that closes only after the window: there the linear model fails. The true model,
// equivalent within the window, prevents a misfit in the headline.
TEST(FitVerdict, APossibleModelThatFitsPreventsAMisfit) {
  SidCase c = small_sid_case();
  const dynamics::Link linear{
      .a = 0, .b = 1, .stiffness = Coefficient::of_parameter(0), .damping = 0.5, .laws = {}};
  dynamics::Link stopped = linear;
  stopped.laws.push_back(
      dynamics::make_law<dynamics::laws::Contact>({5000.0, Coefficient::of_parameter(1)}));
  c.parameters = {{"k", inference::Uniform{0.0, 100.0}}, {"gap", inference::Uniform{0.0, 0.5}}};
  c.models[0].chain.links = {linear};
  c.models[1].chain.links = {stopped};
  for (SidModel& model : c.models) model.noise = {0.002};
  std::vector<double> force;
  for (int n = 0; n < 400; ++n) force.push_back((n < 200 ? 1.5 : 9.0) * std::sin(0.06 * n));
  c.models.push_back(c.models[1]);  // the truth, removed below
  c.truth = SidTruth{.model = 2,
                     .theta = {50.0, 0.14},
                     .noise = {0.002},
                     .samples = 400,
                     .sample_rate_hz = 100.0,
                     .excitations = {{.mass = 1, .signal = TrueExcitation::Sampled{force}}}};
  const SidFindings f = found(measured(c, {.samples = {{0, 200}}}));
  ASSERT_GT(f.models[0].probability(), f.models[1].probability());
  ASSERT_GT(f.models[1].probability(), 0.05);
  EXPECT_TRUE(f.fit_verdict.ok());
  EXPECT_EQ(f.fit_verdict.model, 1);
  EXPECT_EQ(f.fit_verdict.instead_of, 0);
  EXPECT_NE(find<misfit::WorseBeyond>(f.fit_verdict.why_not), nullptr);
  EXPECT_TRUE(std::ranges::any_of(f.remarks, [](const Remark& r) {
    return std::holds_alternative<remark::MostProbableFails>(r);
  }));
}

TEST(FitVerdict, AResponseOfWrongSignIsNotExplained) {
  SidCase c = small_sid_case();
  c.models.push_back(c.models[1]);
  c.models.back().name = "the same";
  c = measured(c);
  for (double& y : c.channels[1].signal.samples) y = -y;
  const SidFindings f = found(c);
  const auto* reason = find<misfit::Unexplained>(f.fit_verdict.why);
  ASSERT_NE(reason, nullptr);
  EXPECT_LT(reason->r2, 0.5);
}

// Displacements of 0.3 m with noise of 3 m: the model is not wrong.
TEST(FitVerdict, ARecordOfNoiseIsNotAMisfit) {
  SidCase c = small_sid_case();
  c.truth->noise = {3.0};
  for (SidModel& model : c.models) model.noise = {3.0};
  c.models.push_back(c.models[1]);
  c.models.back().name = "the same";
  const SidFindings f = found(measured(c));
  EXPECT_LT(f.fit_verdict.r2, 0.5);
  EXPECT_TRUE(f.fit_verdict.ok());
  EXPECT_NE(find<remark::MostlyNoise>(f.remarks), nullptr);
}

// A spring that doubles its stiffness at the end of the window.
TEST(FitVerdict, ReportsAModelThatFailsBeyondTheWindow) {
  SidCase c = small_sid_case();
  c.truth->samples = 400;
  c.truth->model = 0;
  c.models.push_back(c.models[0]);
  c.models.back().name = "the same";
  SidCase stiff = c;
  stiff.truth->theta = {100.0, 0.0};
  c.truth->theta = {50.0, 0.0};
  const SidCase later = measured(stiff);
  c = measured(c, {.samples = {{0, 200}}});
  ASSERT_EQ(c.beyond, 200);
  std::copy(later.channels[1].signal.samples.begin() + 200, later.channels[1].signal.samples.end(),
            c.channels[1].beyond.begin());
  const SidFindings f = found(c);
  const auto* reason = find<misfit::WorseBeyond>(f.fit_verdict.why);
  ASSERT_NE(reason, nullptr);
  EXPECT_EQ(reason->samples, 200);
  EXPECT_GT(reason->beyond, 2.0 * reason->inside);
}

TEST(FreeCubic, FindsTheSpringsMissingInALinearModel) {
  SidCase c = small_sid_case();
  for (SidModel& model : c.models) model.noise = {1e-3};
  c.truth->noise = {1e-3};
  const auto problem = make_sid_problem(measured(c));
  const std::vector<double> theta = {55.0, 0.0};
  const double linear = forward_run(*problem, 0, theta)[0].nrmse;
  const std::vector<double> free = free_cubic_residual(*problem, 0, theta);
  ASSERT_EQ(free.size(), 1U);
  const std::vector<double> y = observed(*problem, 0, theta);
  double mean = 0.0, squares = 0.0;
  for (const double value : y) mean += value / static_cast<double>(y.size());
  for (const double value : y) squares += (value - mean) * (value - mean);
  const double noise = 1e-3 / std::sqrt(squares / static_cast<double>(y.size()));
  EXPECT_GT(linear, 20.0 * noise);
  // 200 samples of noise less four springs: within 5 standard deviations of an sd.
  EXPECT_NEAR(free[0], noise, 5.0 * noise / std::sqrt(2.0 * 200.0));
}

DamageFindings damaged(const DamageCase& damage_case) {
  const auto problem = make_damage_problem(damage_case, {});
  inference::Options engine;
  engine.chains = 2;
  engine.warmup = 500;
  engine.draws = 500;
  const auto posterior = inference::reversible_jump(problem->problem, engine);
  return damage_findings(*problem, posterior, {}, 1);
}

TEST(Plausibility, ReportsALengthInMillimetresBeforeSampling) {
  DamageCase c = small_beam(1);
  c.beam.length = 1000.0;
  c.kinds[0].location = inference::Uniform{0.0, 1000.0};
  const auto problem = make_damage_problem(c, {});
  const std::vector<Remark> doubts = implausible(*problem);
  const auto* doubt = find<remark::FrequenciesOutOfReach>(doubts);
  ASSERT_NE(doubt, nullptr);
  // A damage of 90 % lowers a frequency by far less than the factor.
  EXPECT_NEAR(std::log10(doubt->ratio), 6.0, 0.1);
  EXPECT_EQ(doubt->mode, 1);
  EXPECT_TRUE(implausible(*make_damage_problem(small_beam(1), {})).empty());
  const DamageFindings f = damaged(c);
  EXPECT_NE(find<misfit::BeyondNoise>(f.fit_verdict.why), nullptr);
}

// Chains whose log likelihoods differ by more than the misfit may have missed the damages.
TEST(FitVerdict, StatesWhetherTheChainsOfAMisfitAgree) {
  DamageCase c = small_beam(1);
  c.beam.length = 1000.0;
  c.kinds[0].location = inference::Uniform{0.0, 1000.0};
  const auto problem = make_damage_problem(c, {});
  auto posterior =
      inference::reversible_jump(problem->problem, {.chains = 2, .warmup = 500, .draws = 500});
  // The log likelihoods of both chains are alike, then far apart.
  for (const double apart : {0.0, 1e3, 1e9}) {
    for (std::size_t i = 0; i < 500; ++i)
      for (std::size_t chain = 0; chain < 2; ++chain) {
        posterior.chains[chain].log_prior[i] = 0.0;
        posterior.chains[chain].log_likelihood[i] =
            std::sin(2.4 * static_cast<double>(i)) - apart * static_cast<double>(chain);
      }
    const DamageFindings f = damage_findings(*problem, posterior, {}, 1);
    const auto* reason = find<misfit::BeyondNoise>(f.fit_verdict.why);
    ASSERT_NE(reason, nullptr);
    EXPECT_EQ(reason->chains_agree, apart < 1e9) << apart;
  }
  EXPECT_FALSE(inference::chains_agree(posterior));
}

TEST(Plausibility, ReportsNoiseInPerCentBeforeSampling) {
  DamageCase c = small_beam(1);
  c.kinds[0].severity = inference::Prior(inference::Uniform{0.0, 0.3});
  c.data.cv = 5.0;
  for (std::size_t i = 0; i < c.data.sd_hz.size(); ++i) {
    c.data.sd_hz[i] = 5.0 * c.data.frequencies_hz[i];
  }
  const auto problem = make_damage_problem(c, {});
  const std::vector<Remark> doubts = implausible(*problem);
  const auto* doubt = find<remark::NoiseHidesDamage>(doubts);
  ASSERT_NE(doubt, nullptr);
  EXPECT_DOUBLE_EQ(doubt->cv, 5.0);
  EXPECT_LT(doubt->effect, 0.5);
  const DamageFindings f = damaged(c);
  EXPECT_NE(find<misfit::WithinNoise>(f.fit_verdict.why), nullptr);
}

TEST(Plausibility, ReportsAResponseInMillimetresBeforeSampling) {
  SidCase c = simulated(small_sid_case());
  EXPECT_TRUE(implausible(*make_sid_problem(c)).empty());
  for (double& y : c.channels[1].signal.samples) y *= 1e6;
  const std::vector<Remark> doubts = implausible(*make_sid_problem(c));
  const auto* doubt = find<remark::ResponsesOutOfReach>(doubts);
  ASSERT_NE(doubt, nullptr);
  EXPECT_EQ(doubt->channels.at(0).name, "displacement [m]");
}

TEST(Plausibility, ReportsATruthExcludedByItsPriorsBeforeSampling) {
  SidCase c = small_sid_case();
  c.parameters.push_back({"sigma", inference::LogUniform{1e-3, 1.0}});
  for (SidModel& model : c.models) model.noise = {dynamics::Coefficient::of_parameter(2)};
  c.truth->theta.push_back(0.0);  // not given: the noise value is used
  EXPECT_TRUE(implausible(*make_sid_problem(simulated(c))).empty());
  c.truth->theta[1] = 2e4;
  const std::vector<Remark> doubts = implausible(*make_sid_problem(simulated(c)));
  const auto* doubt = find<remark::TruthOutsidePriors>(doubts);
  ASSERT_NE(doubt, nullptr);
  ASSERT_EQ(doubt->parameters.size(), 1U);
  EXPECT_EQ(doubt->parameters[0].name, "k3");
  EXPECT_EQ(doubt->parameters[0].value, 2e4);
}

TEST(InitialState, IsInferredIfTheWindowDoesNotStartAtRest) {
  SidCase c = small_sid_case();
  c.truth->noise = {1e-3};
  c.truth->samples = 400;
  const SidCase from_rest = measured(c);
  EXPECT_FALSE(moves_at_start(from_rest).has_value());
  // At the largest displacement.
  const auto& y = from_rest.channels[1].signal.samples;
  const int at = static_cast<int>(std::ranges::max_element(y.begin() + 50, y.begin() + 200, {},
                                                           [](double x) { return std::abs(x); }) -
                                  y.begin());
  const auto share = moves_at_start(measured(c, {.samples = {{at, 400}}}));
  ASSERT_TRUE(share.has_value());
  EXPECT_GT(*share, 1.0);
}

}  // namespace
}  // namespace wheeltap::identification
