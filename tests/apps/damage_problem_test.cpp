#include "identification/structural/damage/damage_problem.hpp"
#include "apps/cases/damage_case.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "program.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using testing::HasSubstr;

std::unique_ptr<const DamageProblem> problem(const Json& input) {
  const Workspace where;
  const DamageCaseFile parsed = parse_damage_case(read_case(where.write_json("c.json", input)));
  return explained(parsed, [&] { return make_damage_problem(parsed.damage, {}); });
}

double log_normal_density(double observed, double mean, double sd) {
  const double r = (observed - mean) / sd;
  return -0.5 * r * r - std::log(sd) - 0.5 * std::log(2.0 * std::numbers::pi);
}

TEST(DamageProblem, LikelihoodIsTheContractsGaussian) {
  const Json input = small_case();
  const auto p = problem(input);
  ASSERT_EQ(p->problem.space.size(), 3);
  const auto likelihood = p->problem.likelihood();
  const std::vector<double> observed = input["data"]["frequencies"].get<std::vector<double>>();
  const std::vector<std::vector<double>> thetas = {{}, {0.33, 0.4}, {0.1, 0.2, 0.72, 0.5}};
  for (int m = 0; m < 3; ++m) {
    const auto& theta = thetas[static_cast<std::size_t>(m)];
    fem::Defects defects;
    for (std::size_t i = 0; i < theta.size(); i += 2) {
      defects.damages.push_back({theta[i], theta[i + 1]});
    }
    const auto f = elastic_frequencies(p->damage_case.beam, defects, 3);
    double expected = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      expected += log_normal_density(observed[i], f[i], 0.01 * observed[i]);
    }
    const inference::Evaluation found = likelihood->evaluation(m, theta);
    EXPECT_NEAR(found.log_likelihood, expected, 1e-4 * std::abs(expected));
    ASSERT_EQ(found.residuals.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(found.prediction[i], f[i], 2e-7 * f[i]);
      EXPECT_NEAR(found.residuals[i], (observed[i] - f[i]) / (0.01 * observed[i]), 1e-4);
    }
  }
}

TEST(DamageProblem, InferredNoiseKeepsItsNormaliser) {
  Json input = small_case();
  input["data"]["cov"] = {{"log_uniform", {1e-3, 1e-1}}};
  const auto p = problem(input);
  EXPECT_EQ(p->problem.space.parameter_name(0, 0), "cov");
  const auto likelihood = p->problem.likelihood();
  const std::vector<double> observed = input["data"]["frequencies"].get<std::vector<double>>();
  const auto f = elastic_frequencies(p->damage_case.beam, {}, 3);
  for (const double cv : {0.002, 0.05}) {
    double expected = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      expected += log_normal_density(observed[i], f[i], cv * observed[i]);
    }
    const inference::Evaluation found = likelihood->evaluation(0, std::vector<double>{cv});
    EXPECT_NEAR(found.log_likelihood, expected, 1e-4 * std::abs(expected));
    EXPECT_EQ(found.noise_scale, cv);
  }
}

// Exact for smooth parameters; for a damage's location, the derivative uses frequency differences
// between the midpoints of neighbouring elements, not differences of the likelihood.
TEST(DamageProblem, TheGradientIsThatOfTheLikelihood) {
  for (const bool inferred : {false, true}) {
    Json input = small_case();
    input["data"]["frequencies"] = {13.8, nullptr, 124.0};
    if (inferred) input["data"]["cov"] = {{"log_uniform", {1e-3, 1e-1}}};
    input["data"]["discrepancy"] = {{"cov", 0.003}};
    Json spring = {{"kind", "support"},
                   {"count", {{"max", 1}}},
                   {"location", {{"uniform", {0, 1}}}},
                   {"stiffness", {{"log_uniform", {1e2, 1e6}}}}};
    Json rigid = {{"kind", "support"},
                  {"name", "prop"},
                  {"count", {{"max", 1}}},
                  {"location", {{"uniform", {0, 1}}}}};
    input["damage"] = {input["damage"], spring, rigid};
    const auto p = problem(input);
    const auto likelihood = p->problem.likelihood();
    const int model = p->problem.space.find(std::vector<int>{2, 1, 1});
    // [cv,] two damages, a spring, a rigid support
    std::vector<double> x = {0.33, 0.4, 0.71, 0.2, 0.42, 3e3, 0.87};
    if (inferred) x.insert(x.begin(), 0.02);
    const std::size_t o = inferred ? 1 : 0;
    std::vector<double> gradient(x.size());
    const std::vector<double> f = likelihood->evaluation(model, x).prediction;
    ASSERT_TRUE(likelihood->gradient(model, x, gradient));
    const auto at = [&](std::size_t j, double value) {
      std::vector<double> moved = x;
      moved[j] = value;
      return likelihood->evaluation(model, moved);
    };
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (j == o || j == o + 2) continue;  // location of a damage
      const double h = 1e-4 * x[j];
      const double expected =
          (at(j, x[j] + h).log_likelihood - at(j, x[j] - h).log_likelihood) / (2.0 * h);
      EXPECT_NEAR(gradient[j], expected, 1e-5 * std::abs(expected) + 1e-8 / h) << j;
      EXPECT_NE(gradient[j], 0.0);
    }
    for (const std::size_t j : {o, o + 2}) {
      const double low = j == o ? 0.25 : 0.65;
      const std::vector<double> before = at(j, low).prediction;
      const std::vector<double> after = at(j, low + 0.2).prediction;
      double expected = 0.0;
      for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
        const double sd = p->noise().sd(i, inferred ? x[0] : 0.0, 0.0);
        expected += (p->damage_case.data.frequencies_hz[i] - f[i]) / (sd * sd) *
                    (after[i] - before[i]) / 0.2;
      }
      EXPECT_NEAR(gradient[j], expected, 1e-9 * std::abs(expected)) << j;
    }
  }
}

TEST(DamageProblem, AnEmulatorHasNoGradient) {
  Json input = small_case();
  input["damage"]["location"] = {{"uniform", {0.1, 0.9}}};
  input["predictor"] = Json::parse(R"({"sites": [2, 9], "multipliers": [0.4, 1.0]})");
  const auto p = problem(input);
  std::vector<double> gradient(2);
  EXPECT_FALSE(p->problem.likelihood()->gradient(1, std::vector<double>{0.5, 0.3}, gradient));
  EXPECT_TRUE(p->fe_likelihood()->gradient(1, std::vector<double>{0.5, 0.3}, gradient));
}

TEST(DamageProblem, ModesNotMeasuredAreLeftOut) {
  Json input = small_case();
  input["data"]["frequencies"] = {13.8, nullptr, 124.0};
  const auto p = problem(input);
  const auto likelihood = p->problem.likelihood();
  const auto f = elastic_frequencies(p->damage_case.beam, {}, 3);
  const double expected =
      log_normal_density(13.8, f[0], 0.138) + log_normal_density(124.0, f[2], 1.24);
  const inference::Evaluation found = likelihood->evaluation(0, {});
  EXPECT_NEAR(found.log_likelihood, expected, 1e-5);
  EXPECT_EQ(found.residuals.size(), 2U);
  EXPECT_EQ(found.prediction.size(), 3U);
}

TEST(DamageProblem, FreeFreePredictsElasticModes) {
  Json input = small_case();
  input["beam"]["supports"] = "free-free";
  Json support = {
      {"kind", "support"}, {"count", {{"max", 2}}}, {"location", {{"uniform", {0, 1}}}}};
  input["damage"]["count"]["max"] = 1;
  input["damage"] = {input["damage"], support};
  const auto p = problem(input);
  const auto likelihood = p->problem.likelihood();
  const auto check = [&](const std::vector<int>& counts, const std::vector<double>& theta,
                         const fem::Defects& defects) {
    const auto found = likelihood->evaluation(p->problem.space.find(counts), theta).prediction;
    const auto f = elastic_frequencies(p->damage_case.beam, defects, 3);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(found[i], f[i], 1e-6 * f[i]) << counts[0] << counts[1] << i;
    }
  };
  check({0, 0}, {}, {});
  check({1, 0}, {0.31, 0.4}, {.damages = {{0.31, 0.4}}, .supports = {}});
  check({0, 1}, {0.13}, {.damages = {}, .supports = {{.location = 0.13}}});
  check({1, 2}, {0.31, 0.4, 0.13, 0.8},
        {.damages = {{0.31, 0.4}}, .supports = {{.location = 0.13}, {.location = 0.8}}});
}

TEST(DamageProblem, SeveralKindsCombineWithProductWeights) {
  Json input = small_case();
  input["damage"]["count"] = {{"max", 1}, {"prior", {3, 1}}};
  Json support = {{"kind", "support"},
                  {"count", {{"max", 2}, {"prior", {{"poisson", 1.0}}}}},
                  {"location", {{"uniform", {0.0, 0.5}}}},
                  {"stiffness", {{"log_uniform", {1e2, 1e6}}}}};
  input["damage"] = {input["damage"], support};
  const auto p = problem(input);
  const auto& space = p->problem.space;
  ASSERT_EQ(space.size(), 6);
  const int both = space.find(std::vector<int>{1, 2});
  EXPECT_EQ(space[both].name, "1 damage, 2 supports");
  EXPECT_NEAR(std::exp(space[both].log_prior), 0.25 * 0.2, 1e-12);  // 1/2 of 1, 1, 1/2
  EXPECT_EQ(space[both].dimension, 6);
  const auto components = p->components(both, std::vector<double>{0.2, 0.3, 0.1, 1e3, 0.4, 1e4});
  ASSERT_EQ(components.size(), 3U);
  EXPECT_EQ(components[2].kind, 1);
  EXPECT_EQ(components[2].severity, 1e4);
  EXPECT_FALSE(p->symmetric) << "the supports' prior covers one half only";
}

TEST(DamageProblem, ReflectsWhereBeamAndPriorAreSymmetric) {
  Json input = small_case();
  EXPECT_EQ(problem(input)->problem.reflections.size(), 1U);
  EXPECT_EQ(problem(input)->problem.reflections[0].center, 0.5);
  input["damage"]["location"] = {{"beta", {2, 2}}};
  EXPECT_TRUE(problem(input)->symmetric);
  input["damage"]["location"] = {{"uniform", {0.0, 0.9}}};
  EXPECT_FALSE(problem(input)->symmetric);
  input = small_case();
  input["beam"]["supports"] = "cantilever";
  EXPECT_FALSE(problem(input)->symmetric);
}

TEST(DamageProblem, EmulatorErrorIsAddedToTheNoise) {
  Json input = small_case();
  input["damage"]["location"] = {{"uniform", {0.1, 0.9}}};
  input["predictor"] = Json::parse(R"({"sites": [2, 9], "multipliers": [0.4, 1.0]})");
  const std::vector<double> theta = {0.5, 0.3};
  const auto aware = problem(input);
  input["predictor"]["emulator_error"] = false;
  input["predictor"]["symmetrise"] = true;  // the default with emulator error
  const auto blind = problem(input);
  const auto with = aware->problem.likelihood(), without = blind->problem.likelihood();
  const inference::Evaluation naive = without->evaluation(1, theta);
  double sum = 0.0, expected = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double f = naive.prediction[i], observed = input["data"]["frequencies"][i].get<double>();
    // Grows with the compliance added by the damage, 0.3 / 0.7 of an element's (and 0.001).
    const double variance = aware->emulator->error(1).scale[i] * (0.3 / 0.7 + 1e-3);
    EXPECT_GT(variance, 0.0);
    sum += log_normal_density(observed, f, 0.01 * observed);
    expected += log_normal_density(observed, f, std::hypot(0.01 * observed, std::sqrt(variance)));
  }
  EXPECT_NEAR(naive.log_likelihood, sum, 1e-9);
  EXPECT_NEAR(with->log_likelihood(1, theta), expected, 1e-9);
  EXPECT_EQ(with->log_likelihood(0, {}), without->log_likelihood(0, {})) << "intact is exact";
}

TEST(DamageProblem, DiscrepancyIsAddedToTheNoise) {
  Json input = small_case();
  input["data"]["discrepancy"] = {{"cov", 0.02}};
  const std::vector<double> observed = input["data"]["frequencies"].get<std::vector<double>>();
  const auto expected = [&](const std::vector<double>& f, double cv) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += log_normal_density(observed[i], f[i], std::hypot(cv, 0.02) * observed[i]);
    }
    return sum;
  };
  const auto p = problem(input);
  const auto f = elastic_frequencies(p->damage_case.beam, {}, 3);
  EXPECT_NEAR(p->problem.likelihood()->log_likelihood(0, {}), expected(f, 0.01), 1e-5);
  input["data"]["cov"] = {{"log_uniform", {1e-3, 1e-1}}};
  const auto inferred = problem(input);
  EXPECT_NEAR(inferred->problem.likelihood()->log_likelihood(0, std::vector<double>{0.03}),
              expected(f, 0.03), 1e-5);
}

TEST(DamageProblem, AnExactEmulatorScreensAndTheFiniteElementsDecide) {
  Json input = small_case();
  const auto fe = problem(input);
  input["predictor"] = Json::parse(R"({"sites": [1, 4, 7, 10], "multipliers": [0.4, 1.0]})");
  const auto emulated = problem(input);
  input["predictor"]["exact"] = true;
  const auto exact = problem(input);
  ASSERT_TRUE(exact->problem.screen);
  EXPECT_FALSE(emulated->problem.screen);
  const std::vector<double> theta = {0.23, 0.2, 0.55, 0.3};
  EXPECT_EQ(exact->problem.likelihood()->log_likelihood(2, theta),
            fe->problem.likelihood()->log_likelihood(2, theta));
  EXPECT_EQ(exact->problem.screen()->log_likelihood(2, theta),
            emulated->problem.likelihood()->log_likelihood(2, theta));
  EXPECT_NE(exact->problem.screen()->log_likelihood(2, theta),
            exact->problem.likelihood()->log_likelihood(2, theta));
}

TEST(DamageProblem, RefusesAPriorOutsideTheEmulatorsBox) {
  Json input = small_case();
  input["predictor"] = Json::parse(R"({"sites": [2, 9], "multipliers": [0.4, 1.0]})");
  try {
    (void)problem(input);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    EXPECT_THAT(failure.what(), HasSubstr("/damage/location"));
    EXPECT_THAT(failure.what(), HasSubstr("uniform [0, 1] exceeds the training domain"));
  }
}

}  // namespace
}  // namespace wheeltap::apps
