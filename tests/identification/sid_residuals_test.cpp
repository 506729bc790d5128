#include "identification/sid/sid_residuals.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "base/random.hpp"
#include "identification/sid/findings/sid_findings.hpp"
#include "identification/sid/sid_units.hpp"
#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

// The residuals of the linear model are smooth; those of the true model are the noise.
TEST(SidResiduals, ChoosesOrdersPerModel) {
  SidCase c = simulated(small_sid_case());
  for (SidModel& model : c.models) model.residuals.chosen_kind = &kAutoregressive;
  choose_residuals(c, 1, 2);
  const int order = c.models[0].residuals.model->value();
  EXPECT_GE(order, 1);
  EXPECT_LE(order, kAutoregressive.highest);
  EXPECT_TRUE(c.models[1].residuals.model->is_white());
  EXPECT_EQ(c.models[1].parameters, (std::vector<int>{0, 1}));
  EXPECT_EQ(c.models[0].parameters.size(), 1U + static_cast<std::size_t>(order));
  EXPECT_EQ(c.parameters[2].name, "ar[1]");
}

TEST(SidResiduals, KeepsAGivenOrder) {
  SidCase c = simulated(small_sid_case());
  add_residuals(c, c.models[0], kAutoregressive.make(2));
  c.unite();
  const std::vector<int> before = c.models[0].parameters;
  choose_residuals(c, 1, 1);
  EXPECT_EQ(c.models[0].parameters, before);
  EXPECT_EQ(before.size(), 3U);
}

TEST(SidResiduals, EveryKindMakesItsModels) {
  for (const ResidualKind* kind : residual_kinds()) {
    EXPECT_TRUE(kind->make(0)->is_white()) << kind->key;
    EXPECT_EQ(kind->make(kind->highest)->kind(), kind);
    EXPECT_EQ(kind->make(kind->highest)->value(), kind->highest);
  }
}

/// A user-defined residual model: E[r_n r_{n+k}] = σ² exp(-k / τ), τ in samples.
/// With ρ = exp(-1 / τ), r_n given r_{n-1} is N(ρ r_{n-1}, σ² (1 - ρ²)).
class CorrelationTime final : public ResidualModel {
 public:
  ResidualWords words() const override { return {.article = "a", .name = "correlation time"}; }
  std::vector<ResidualParameter> parameters(const std::string& channel) const override {
    return {{"tau" + channel, inference::LogUniform{0.1, 100.0}, "1"}};
  }
  double log_density(std::span<const double> residuals, double sigma,
                     std::span<const double> c) const override {
    if (!(sigma > 0.0 && c[0] > 0.0)) return -std::numeric_limits<double>::infinity();
    const auto n = static_cast<double>(residuals.size());
    std::vector<double> e(residuals.size());
    standardise(residuals, c, e);
    const double squares = std::inner_product(e.begin(), e.end(), e.begin(), 0.0);
    return -0.5 * (n * std::log(2.0 * M_PI * sigma * sigma) +
                   (n - 1.0) * std::log1p(-std::exp(-2.0 / c[0])) + squares / (sigma * sigma));
  }
  void standardise(std::span<const double> residuals, std::span<const double> c,
                   std::span<double> out) const override {
    const double rho = std::exp(-1.0 / c[0]);
    for (std::size_t n = residuals.size(); n-- > 1;)
      out[n] = (residuals[n] - rho * residuals[n - 1]) / std::sqrt(1.0 - rho * rho);
    out[0] = residuals[0];
  }
};

const remark::ColouredResiduals* coloured(const SidFindings& findings, const std::string& model) {
  for (const Remark& remark : findings.remarks) {
    const auto* of = std::get_if<remark::ColouredResiduals>(&remark);
    if (of != nullptr && of->model == model) return of;
  }
  return nullptr;
}

// A new residual model needs only its class: the Duffing record with correlated noise, ρ = 0.9.
TEST(SidResiduals, IdentifiesAUserDefinedModel) {
  constexpr double kTau = 9.5, kSd = 0.02;
  SidCase c = small_sid_case();
  c.truth->noise = {0.0};
  c.truth->samples = 1000;
  c = simulated(std::move(c));
  base::Random random(5, 0, 0, base::Purpose::test);
  const double rho = std::exp(-1.0 / kTau);
  double noise = kSd * random.normal();
  for (double& y : c.channels[1].signal.samples) {
    y += noise;
    noise = rho * noise + kSd * std::sqrt(1.0 - rho * rho) * random.normal();
  }
  c.models.erase(c.models.begin());
  c.models[0].weight = 1.0;
  c.models[0].noise = {c.parameter("sigma", inference::LogUniform{1e-3, 1.0})};
  c.truth->model = 0;
  add_residuals(c, c.models[0], std::make_shared<const CorrelationTime>());
  c.unite();
  EXPECT_EQ(parameter_units(c).at("tau"), "1");

  inference::Options engine;
  engine.chains = 2;
  engine.warmup = 1000;
  engine.draws = 1000;
  const SidRun run = run_sid(c, {.engine = engine});
  // The density equals that of an autoregression of order 1.
  SidCase same = c;
  same.models[0].residuals.model = kAutoregressive.make(1);
  EXPECT_NEAR(log_likelihood(*run.problem, 0, {50.0, 1000.0, 0.02, kTau}),
              log_likelihood(*make_sid_problem(same), 0, {50.0, 1000.0, 0.02, rho}), 1e-8);

  const SidFindings found = sid_findings(run, predict(*run.problem, run.posterior));
  const double truth[] = {50.0, 1000.0, kSd, kTau};
  const char* const names[] = {"k", "k3", "sigma", "tau"};
  for (std::size_t p = 0; p < 4; ++p) {
    const auto* parameter = found.models[0].find(names[p]);
    ASSERT_NE(parameter, nullptr) << names[p];
    EXPECT_LT(std::abs(parameter->q50 - truth[p]), 4.0 * parameter->sd) << names[p];
    EXPECT_LT(parameter->sd, 0.5 * truth[p]) << names[p];
  }
  const ChannelFit& fit = found.of_models[0]->at_best[0];
  ASSERT_TRUE(fit.whiteness && fit.plain_whiteness);
  EXPECT_TRUE(fit.whiteness->of_innovations);
  EXPECT_TRUE(fit.whiteness->white());
  EXPECT_FALSE(fit.plain_whiteness->white());
  EXPECT_EQ(coloured(found, "duffing"), nullptr);
}

}  // namespace
}  // namespace wheeltap::identification
