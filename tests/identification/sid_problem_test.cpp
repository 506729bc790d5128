#include "identification/sid/sid_problem.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "identification/invalid_input.hpp"
#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Coefficient;
using testing::HasSubstr;

double gaussian(double squares, int n, double sigma) {
  return -0.5 * n * std::log(2.0 * std::numbers::pi * sigma * sigma) -
         0.5 * squares / (sigma * sigma);
}

/// The case with one more parameter, which all models use.
SidCase with_parameter(SidCase c, const std::string& name, const inference::Prior& prior,
                       double truth) {
  c.parameters.push_back({name, prior});
  for (SidModel& model : c.models) {
    model.parameters.push_back(static_cast<int>(c.parameters.size()) - 1);
  }
  c.truth->theta.push_back(truth);
  return c;
}

TEST(SidProblem, LogLikelihoodIsGaussianInTheResiduals) {
  const auto problem = make_sid_problem(simulated(small_sid_case()));
  std::vector<double> residuals(200);
  ASSERT_TRUE(
      problem->misfits[1].residuals(problem->theta(1, std::vector{50.0, 1000.0}), residuals));
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  EXPECT_NEAR(log_likelihood(*problem, 1, {50.0, 1000.0}), gaussian(squares, 200, 0.05), 1e-9);
  // At the truth only the noise remains: χ² with 200 degrees of freedom, sd 20; five sd.
  EXPECT_NEAR(squares / (0.05 * 0.05), 200.0, 100.0);
  // The linear model is the Duffing model without its cubic spring. Its exact solution and the
  // Runge-Kutta steps of the other differ by (ωh)⁴/120 of a frequency: 1e-6 here.
  EXPECT_NEAR(log_likelihood(*problem, 0, {50.0}), log_likelihood(*problem, 1, {50.0, 0.0}), 0.1);
  EXPECT_EQ(log_likelihood(*problem, 1, {50.0, -1e6}), -std::numeric_limits<double>::infinity());
}

TEST(SidProblem, NoiseMayBeAParameter) {
  SidCase c = with_parameter(small_sid_case(), "sigma", inference::HalfNormal{0.1}, 0.05);
  for (SidModel& model : c.models) model.noise = {Coefficient::of_parameter(2)};
  const auto inferred = make_sid_problem(simulated(c));
  const auto known = make_sid_problem(simulated(small_sid_case()));
  EXPECT_NEAR(log_likelihood(*inferred, 1, {50.0, 1000.0, 0.05}),
              log_likelihood(*known, 1, {50.0, 1000.0}), 1e-9);
}

TEST(SidProblem, NoiseMayDifferBetweenChannels) {
  SidCase c = small_sid_case();
  c.channels.push_back({.column = "velocity [m/s]",
                        .role = SidChannel::Role::response,
                        .mass = 1,
                        .quantity = dynamics::Quantity::velocity});
  for (SidModel& model : c.models) model.noise = {0.05, 0.5};
  c.truth->noise = {0.05, 0.5};
  const auto both = make_sid_problem(simulated(c));
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

TEST(SidProblem, AnUnknownScaleHasItsJacobian) {
  SidCase c = small_sid_case();
  c.channels[1].signal.scale = 2.0;
  const auto known = make_sid_problem(simulated(c));
  c = with_parameter(c, "gain", inference::LogUniform{0.1, 10.0}, 2.0);
  c.channels[1].signal.scale = Coefficient::of_parameter(2);
  const auto inferred = make_sid_problem(simulated(c));
  EXPECT_NEAR(log_likelihood(*inferred, 0, {50.0, 2.0}),
              log_likelihood(*known, 0, {50.0}) + 200 * std::log(2.0), 1e-8);
}

TEST(SidProblem, AutoregressionWithoutCorrelationIsWhite) {
  const auto white = make_sid_problem(simulated(small_sid_case()));
  SidCase c = with_parameter(small_sid_case(), "ar[1]", inference::Uniform{-1.0, 1.0}, 0.0);
  c = with_parameter(c, "ar[2]", inference::Uniform{-1.0, 1.0}, 0.0);
  for (SidModel& model : c.models) {
    model.residuals = {kAutoregressive.make(2),
                       {{Coefficient::of_parameter(2), Coefficient::of_parameter(3)}}};
  }
  const auto coloured = make_sid_problem(simulated(c));
  ASSERT_EQ(coloured->problem.space[0].dimension, 3);  // k, ar[1], ar[2]
  EXPECT_NEAR(log_likelihood(*coloured, 0, {50.0, 0.0, 0.0}), log_likelihood(*white, 0, {50.0}),
              1e-8);
  EXPECT_NE(log_likelihood(*coloured, 0, {50.0, 0.5, 0.0}), log_likelihood(*white, 0, {50.0}));
}

/// Compares slopes of Likelihood::gauss_newton with central differences of ln p.
void expect_slopes(const SidProblem& problem, int model, const std::vector<double>& x,
                   double tolerance) {
  const std::size_t d = x.size();
  std::vector<double> steps, gradient(d), information(d * d);
  for (const double value : x) steps.push_back(1e-5 * std::max(std::abs(value), 1e-3));
  ASSERT_TRUE(problem.problem.likelihood()->gauss_newton(model, x, steps, gradient, information));
  for (std::size_t i = 0; i < d; ++i) {
    std::vector<double> up = x, down = x;
    up[i] += steps[i];
    down[i] -= steps[i];
    const double slope =
        0.5 * (log_likelihood(problem, model, up) - log_likelihood(problem, model, down));
    EXPECT_NEAR(gradient[i], slope, tolerance * std::sqrt(information[i * d + i])) << i;
    for (std::size_t j = 0; j < d; ++j)
      EXPECT_EQ(information[i * d + j], information[j * d + i]) << i << ' ' << j;
  }
}

TEST(SidProblem, GaussNewtonHasTheSlopesOfTheLikelihood) {
  SidCase c = with_parameter(small_sid_case(), "sigma", inference::HalfNormal{0.1}, 0.05);
  c = with_parameter(c, "gain", inference::LogUniform{0.1, 10.0}, 2.0);
  c.channels[1].signal.scale = Coefficient::of_parameter(3);
  for (SidModel& model : c.models) model.noise = {Coefficient::of_parameter(2)};
  const auto white = make_sid_problem(simulated(c));
  expect_slopes(*white, 1, {49.0, 1100.0, 0.06, 2.01}, 1e-3);
  c = with_parameter(c, "ar[1]", inference::Uniform{-1.0, 1.0}, 0.0);
  c = with_parameter(c, "ar[2]", inference::Uniform{-1.0, 1.0}, 0.0);
  for (SidModel& model : c.models)
    model.residuals = {kAutoregressive.make(2),
                       {{Coefficient::of_parameter(4), Coefficient::of_parameter(5)}}};
  const auto coloured = make_sid_problem(simulated(c));
  expect_slopes(*coloured, 1, {49.0, 1100.0, 0.06, 2.01, 0.5, -0.2}, 1e-3);
}

// For an sd and fixed residuals: one Newton step leads to √(S/N).
TEST(SidProblem, GaussNewtonLeadsToTheBestNoise) {
  SidCase c = with_parameter(small_sid_case(), "sigma", inference::HalfNormal{0.1}, 0.05);
  for (SidModel& model : c.models) model.noise = {Coefficient::of_parameter(2)};
  const auto problem = make_sid_problem(simulated(c));
  std::vector<double> residuals(200);
  ASSERT_TRUE(problem->misfits[0].residuals(problem->theta(0, std::vector{50.0, 1.0}), residuals));
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  const double best = std::sqrt(squares / 200.0);
  const std::vector<double> x{50.0, 3.0 * best}, steps{1e-4, 1e-5};
  std::vector<double> gradient(2), information(4);
  ASSERT_TRUE(problem->problem.likelihood()->gauss_newton(0, x, steps, gradient, information));
  const double step = gradient[1] / information[3] * steps[1];
  EXPECT_NEAR(step / x[1], std::log(best / x[1]), 1e-9);
  EXPECT_EQ(information[1], 0.0);
}

// Log likelihoods of several records add up, for every way of evaluation, and early rejection must
// not reject a value above the floor.
TEST(SidProblem, SeveralRecordsAddTheirLikelihoods) {
  SidCase c = small_sid_case();
  SidCase second = small_sid_case();
  second.truth->seed = 2;
  second.number = 2;
  second = simulated(std::move(second), {.samples = std::pair(30, 180), .lead_in = 30});
  const auto alone = make_sid_problem(second);
  c = simulated(std::move(c));
  const auto first = make_sid_problem(c);
  c.further = {second};
  c.unite();
  const auto both = make_sid_problem(c);
  const std::vector<double> x = {49.0, 900.0};
  const double sum = log_likelihood(*first, 1, x) + log_likelihood(*alone, 1, x);
  EXPECT_NEAR(log_likelihood(*both, 1, x), sum, 1e-9 * std::abs(sum));
  const auto likelihood = both->problem.likelihood();
  EXPECT_NEAR(likelihood->log_likelihood_above(sum - 0.01, 1, x), sum, 1e-9 * std::abs(sum));
  EXPECT_LT(likelihood->log_likelihood_above(sum + 0.01, 1, x), sum);
  std::vector<double> xs = x, out(2);
  xs.insert(xs.end(), {50.0, 1000.0});
  likelihood->log_likelihoods(1, xs, out);
  EXPECT_NEAR(out[0], sum, 1e-9 * std::abs(sum));
  EXPECT_GT(out[1], out[0]);
  expect_slopes(*both, 1, x, 1e-3);
  // A shortened problem shortens all records.
  const auto part = both->problem.shortened(100);
  const auto part_of = [&](const SidProblem& p) {
    return p.problem.shortened(100)->likelihood()->log_likelihood(1, x);
  };
  const double parts = part_of(*first) + part_of(*alone);
  EXPECT_NEAR(part->likelihood()->log_likelihood(1, x), parts, 1e-9 * std::abs(parts));
}

TEST(SidProblem, AContactOutOfReachChangesNothing) {
  SidCase c = small_sid_case();
  c.models[1].chain.links[0].laws = {dynamics::make_law<dynamics::laws::Contact>(
      {Coefficient::of_parameter(1), 1e3}, dynamics::Side::closing)};
  c.truth->theta[1] = 10.0;
  const auto problem = make_sid_problem(simulated(c));
  EXPECT_NEAR(log_likelihood(*problem, 0, {50.0}), log_likelihood(*problem, 1, {50.0, 10.0}), 0.1);
}

TEST(SidProblem, AnInferredInitialStateExplainsAWindow) {
  const auto rest = make_sid_problem(simulated(small_sid_case(), {.samples = std::pair(100, 200)}));
  const auto led = make_sid_problem(
      simulated(small_sid_case(), {.samples = std::pair(100, 200), .lead_in = 100}));
  EXPECT_GT(log_likelihood(*led, 1, {50.0, 1000.0}),
            log_likelihood(*rest, 1, {50.0, 1000.0}) + 10.0);
  SidCase inferred = simulated(small_sid_case(), {.samples = std::pair(100, 200)});
  for (SidModel& model : inferred.models) {
    infer_initial(inferred, model);
    model.parameters = inferred.parameters_of(model);
  }
  ASSERT_EQ(inferred.models[0].parameters.size(), 3U);  // k, y0[1], v0[1]
  EXPECT_EQ(inferred.parameters[2].name, "y0[1]");
  EXPECT_GT(inferred.parameters[3].prior.sd(), inferred.parameters[2].prior.sd());  // ω > 1 rad/s
}

TEST(SidProblem, BandLimitedExcitationIsUpsampled) {
  const SidCase c = simulated(small_sid_case(), {.band_limited = true, .upsample = 4});
  EXPECT_EQ(c.stride, 4);
  EXPECT_EQ(c.channels[0].signal.samples.size(), 199U * 4 + 1);
  EXPECT_EQ(c.channels[1].signal.samples.size(), 200U);
  EXPECT_TRUE(std::isfinite(log_likelihood(*make_sid_problem(c), 0, {50.0})));
}

// Simulation and fit interpolate the excitation in the same way.
TEST(SidSimulation, InterpolatesTheExcitationAsDeclared) {
  SidCase c = small_sid_case();
  c.truth->noise = {1e-12};
  c.truth->excitations = {{.mass = 1, .signal = TrueExcitation::BandLimited{1.0, 35.0, 100.0}}};
  const auto off = [&](int points, bool band_limited) {
    c.truth->points_a_sample = points;
    const auto problem = make_sid_problem(
        simulated(c, {.band_limited = band_limited,
                      .upsample = band_limited ? std::optional<int>(8) : std::nullopt}));
    std::vector<double> residuals(200);
    EXPECT_TRUE(
        problem->misfits[1].residuals(problem->theta(1, std::vector{50.0, 1000.0}), residuals));
    const auto size = [](const std::vector<double>& x) {
      return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0));
    };
    return size(residuals) / size(problem->sid_case.channels[1].signal.samples);
  };
  EXPECT_LT(off(8, true), 1e-5);
  EXPECT_LT(off(1, false), 1e-4);
  // At the dominant 3 Hz, linear interpolation keeps sinc²(3 / 100) = 0.997 of the force.
  EXPECT_GT(off(1, true), 0.002);
  EXPECT_GT(off(8, false), 0.002);
}

TEST(SidProblem, NamesTheInvalidPart) {
  const auto refused = [](const SidCase& c, InvalidInput::Part part, int index, const char* word) {
    try {
      static_cast<void>(make_sid_problem(simulated(c)));
      FAIL() << "not rejected: " << word;
    } catch (const InvalidInput& error) {
      EXPECT_EQ(error.part(), part) << error.what();
      EXPECT_EQ(error.index(), index);
      EXPECT_THAT(error.what(), HasSubstr(word));
    }
  };
  SidCase c = small_sid_case();
  c.truth.reset();
  EXPECT_THROW(static_cast<void>(simulate_record(c, 1)), InvalidInput);
  c = small_sid_case();
  c.truth->excitations[0].signal = TrueExcitation::BandLimited{10.0, 60.0, 1.0};  // Nyquist: 50
  refused(c, InvalidInput::Part::excitation, 0, "50");
  c = small_sid_case();
  c.channels[0].column = "forze";
  c.truth->excitations.clear();
  const signals::Record record = simulate_record(small_sid_case(), 1);
  try {
    take_record(c, record, {});
    FAIL() << "not rejected";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.part(), InvalidInput::Part::channel);
    EXPECT_THAT(error.what(), HasSubstr("force [N]"));
  }
}

}  // namespace
}  // namespace wheeltap::identification
