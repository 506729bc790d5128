#include "apps/sid_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sid_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;

double gaussian(double squares, int n, double sigma) {
  return -0.5 * n * std::log(2.0 * std::numbers::pi * sigma * sigma) -
         0.5 * squares / (sigma * sigma);
}

TEST(SidProblem, LogLikelihoodIsGaussianInTheResiduals) {
  const Workspace where;
  const auto problem = make_sid_problem(parse_sid(where, small_sid_case()));
  std::vector<double> residuals(200);
  ASSERT_TRUE(
      problem->misfits[1].residuals(problem->theta(1, std::vector{50.0, 1000.0}), residuals));
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  EXPECT_NEAR(log_likelihood(*problem, 1, {50.0, 1000.0}), gaussian(squares, 200, 0.05), 1e-9);
  // At the truth only the noise is left: χ² of 200 degrees of freedom, sd 20, five sd wide.
  EXPECT_NEAR(squares / (0.05 * 0.05), 200.0, 100.0);
  // The linear model is the Duffing model without its cubic spring. Its exact solution and the
  // Runge-Kutta steps of the other differ by (ωh)⁴/120 of a frequency: 1e-6 here.
  EXPECT_NEAR(log_likelihood(*problem, 0, {50.0}), log_likelihood(*problem, 1, {50.0, 0.0}), 0.1);
  EXPECT_EQ(log_likelihood(*problem, 1, {50.0, -1e6}), -std::numeric_limits<double>::infinity());
}

TEST(SidProblem, NoiseMayBeAParameterOrOneAChannel) {
  const Workspace where;
  json c = small_sid_case();
  c["parameters"]["sigma"] = {{"half_normal", 0.1}};
  for (auto& model : c["models"]) model["noise"] = "sigma";
  const auto one = make_sid_problem(parse_sid(where, c));
  const auto known = make_sid_problem(parse_sid(where, small_sid_case()));
  // Parameters are in the order of their names: k, k3, sigma.
  EXPECT_NEAR(log_likelihood(*one, 1, {50.0, 1000.0, 0.05}),
              log_likelihood(*known, 1, {50.0, 1000.0}), 1e-9);

  json two = small_sid_case();
  two["record"]["channels"].push_back(
      {{"column", "velocity [m/s]"}, {"role", "response"}, {"mass", 1}, {"quantity", "velocity"}});
  two["models"][0]["noise"] = {0.05, 0.5};
  two["models"][1]["noise"] = {0.05, 0.5};
  two["truth"]["noise"] = {0.05, 0.5};
  const auto both = make_sid_problem(parse_sid(where, two));
  std::vector<double> residuals(400);
  ASSERT_TRUE(both->misfits[1].residuals(both->theta(1, std::vector{50.0, 1000.0}), residuals));
  double first = 0.0, second = 0.0;
  for (std::size_t n = 0; n < 200; ++n) {
    first += residuals[n] * residuals[n];
    second += residuals[200 + n] * residuals[200 + n];
  }
  EXPECT_NEAR(log_likelihood(*both, 1, {50.0, 1000.0}),
              gaussian(first, 200, 0.05) + gaussian(second, 200, 0.5), 1e-9);
}

TEST(SidProblem, AnUnknownScaleCarriesItsJacobian) {
  const Workspace where;
  json c = small_sid_case();
  c["record"]["channels"][1]["scale"] = 2.0;
  const auto known = make_sid_problem(parse_sid(where, c));
  c["record"]["channels"][1]["scale"] = "gain";
  c["parameters"]["gain"] = {{"log_uniform", {0.1, 10}}};
  c["truth"]["parameters"]["gain"] = 2.0;
  const auto inferred = make_sid_problem(parse_sid(where, c));
  EXPECT_NEAR(log_likelihood(*inferred, 0, {2.0, 50.0}),
              log_likelihood(*known, 0, {50.0}) + 200 * std::log(2.0), 1e-8);
}

TEST(SidProblem, AutoregressionOfNoCorrelationIsWhite) {
  const Workspace where;
  const auto white = make_sid_problem(parse_sid(where, small_sid_case()));
  json c = small_sid_case();
  c["residuals"] = {{"ar", 2}};
  const auto coloured = make_sid_problem(parse_sid(where, c));
  ASSERT_EQ(coloured->problem.space[0].dimension, 3);  // k, ar[1], ar[2]
  EXPECT_NEAR(log_likelihood(*coloured, 0, {50.0, 0.0, 0.0}), log_likelihood(*white, 0, {50.0}),
              1e-8);
  EXPECT_NE(log_likelihood(*coloured, 0, {50.0, 0.5, 0.0}), log_likelihood(*white, 0, {50.0}));
}

TEST(SidProblem, AContactOutOfReachChangesNothing) {
  const Workspace where;
  json c = small_sid_case();
  c["models"][1]["links"][0].erase("cubic");
  c["models"][1]["links"][0]["contact"] = {{"stiffness", "k3"}, {"gap", 1e3}, {"side", "closing"}};
  c["truth"]["parameters"]["k3"] = 10.0;
  const auto problem = make_sid_problem(parse_sid(where, c));
  EXPECT_NEAR(log_likelihood(*problem, 0, {50.0}), log_likelihood(*problem, 1, {50.0, 10.0}), 0.1);
}

TEST(SidProblem, AnInferredStartExplainsAWindowWithoutItsPast) {
  const Workspace where;
  json c = small_sid_case();
  c["record"]["samples"] = {100, 200};
  const auto rest = make_sid_problem(parse_sid(where, c));
  c["record"]["lead_in"] = 100;
  const auto led = make_sid_problem(parse_sid(where, c));
  c["record"].erase("lead_in");
  c["record"]["initial"] = "inferred";
  const SidCase inferred = parse_sid(where, c);
  ASSERT_EQ(inferred.models[0].parameters.size(), 3U);  // k, y0[1], v0[1]
  EXPECT_EQ(inferred.parameters[2].name, "y0[1]");
  EXPECT_GT(inferred.parameters[3].prior.sd(), inferred.parameters[2].prior.sd());  // ω > 1 rad/s
  EXPECT_GT(log_likelihood(*led, 1, {50.0, 1000.0}),
            log_likelihood(*rest, 1, {50.0, 1000.0}) + 10.0);
}

TEST(SidProblem, BandLimitedExcitationIsUpsampled) {
  const Workspace where;
  json c = small_sid_case();
  c["record"]["between_samples"] = "band-limited";
  c["record"]["upsample"] = 4;
  const SidCase sid_case = parse_sid(where, c);
  EXPECT_EQ(sid_case.stride, 4);
  EXPECT_EQ(sid_case.channels[0].signal.samples.size(), 199U * 4 + 1);
  EXPECT_EQ(sid_case.channels[1].signal.samples.size(), 200U);
  EXPECT_TRUE(std::isfinite(log_likelihood(*make_sid_problem(sid_case), 0, {50.0})));
}

}  // namespace
}  // namespace wheeltap::apps
