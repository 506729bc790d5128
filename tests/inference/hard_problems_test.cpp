// The answers of hard_problems.cpp by a second method: bridge sampling between exact posterior
// draws and a mixture fitted to them, quadrature, or importance sampling.
#include "tests/inference/hard_problems.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "inference/evidence/bridge_sampling.hpp"
#include "tests/inference/published_problems.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kHardSigmas = 4.9;

const HardProblem& hard_problem(const std::string& name) {
  for (const HardProblem& p : hard_problems()) {
    if (p.name == name) return p;
  }
  throw std::invalid_argument("no problem is called '" + name + "'");
}

TEST(HardProblems, NamesAreUniqueAndProbabilitiesFollowFromEvidences) {
  std::vector<std::string> names;
  for (const HardProblem& p : hard_problems()) {
    names.push_back(p.name);
    EXPECT_EQ(p.probability.size(), static_cast<std::size_t>(p.problem.space.size())) << p.name;
    EXPECT_NEAR(std::accumulate(p.probability.begin(), p.probability.end(), 0.0), 1.0, 1e-12);
    EXPECT_EQ(p.dimension, p.problem.space.max_dimension()) << p.name;
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

// Exact draws instead of chains. Bridge sampling uses only values of the density, so that a wrong
// normaliser, cut-off or draw shows.
void check_by_bridge(const HardProblem& p, int model, double largest_error) {
  const Model& m = p.problem.space[model];
  constexpr int kChains = 4, kDraws = 5000;
  ModelSamples samples;
  ModelPosterior posterior(p.problem, model);
  std::vector<double> x(static_cast<std::size_t>(m.dimension)), z(x.size());
  for (int c = 0; c < kChains; ++c) {
    samples.z.emplace_back(kDraws, m.dimension);
    samples.x.emplace_back(kDraws, m.dimension);
    samples.log_posterior.emplace_back();
    samples.log_likelihood.emplace_back();
    for (int i = 0; i < kDraws; ++i) {
      base::Random random(1, static_cast<std::uint64_t>(c), static_cast<std::uint64_t>(i),
                          base::Purpose::test);
      p.draw(model, random, x);
      for (int j = 0; j < m.dimension; ++j) {
        const auto k = static_cast<std::size_t>(j);
        z[k] = p.problem.space.prior(model, j).to_standard_normal(x[k]);
        samples.x.back()(i, j) = x[k];
        samples.z.back()(i, j) = z[k];
      }
      const ModelPosterior::Value value = posterior(z);
      ASSERT_TRUE(std::isfinite(value.log_posterior())) << p.name;
      samples.log_posterior.back().push_back(value.log_posterior());
      samples.log_likelihood.back().push_back(value.log_likelihood);
    }
  }
  const Evidence e = bridge_sampling(p.problem, model, samples, {.seed = 1});
  const double exact = p.log_evidence[static_cast<std::size_t>(model)];
  std::printf("    %-32s %s: exact %.4f, bridge %+.4f ± %.4f\n", p.name.c_str(), m.name.c_str(),
              exact, e.log_evidence - exact, e.standard_error);
  EXPECT_NEAR(e.log_evidence, exact, kHardSigmas * e.standard_error + 1e-9) << p.name;
  EXPECT_LT(e.standard_error, largest_error) << p.name;
}

class HardProblemAnswers : public testing::TestWithParam<std::size_t> {};

TEST_P(HardProblemAnswers, AgreeWithBridgeSampling) {
  const HardProblem& p = hard_problems()[GetParam()];
  if (p.family == "counts with a spot" || p.family == "bananas")
    GTEST_SKIP() << "by importance sampling below";
  for (int model = 0; model < p.problem.space.size(); ++model) {
    if (p.problem.space[model].dimension > 0) check_by_bridge(p, model, 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(All, HardProblemAnswers,
                         testing::Range<std::size_t>(0, hard_problems().size()),
                         [](const testing::TestParamInfo<std::size_t>& at) {
                           return identifier(hard_problems()[at.param].name);
                         });

// Draws from ½ · prior + ½ · a random component in the spot: the weights are bounded.
TEST(HardProblems, CountsWithASpotAgreeWithImportanceSampling) {
  const HardProblem& p = hard_problem("counts 0..10 with a spot");
  const auto likelihood = p.problem.likelihood();
  constexpr double kX = 0.62, kY = 0.27, kWidth = 1e-3;
  for (int k = 1; k <= 10; k += 3) {
    std::vector<double> x(static_cast<std::size_t>(2 * k));
    constexpr int kDraws = 20000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      base::Random random(2, static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(i),
                          base::Purpose::test);
      for (double& v : x) v = random.uniform();
      if (random.uniform() < 0.5) {
        const auto j = static_cast<std::size_t>(2 * random.index(k));
        x[j] = kX + kWidth * random.normal();
        x[j + 1] = kY + kWidth * random.normal();
      }
      double density = 0.5;
      for (std::size_t j = 0; j < x.size(); j += 2) {
        const double a = (x[j] - kX) / kWidth, b = (x[j + 1] - kY) / kWidth;
        density += 0.5 / k * std::exp(-0.5 * (a * a + b * b)) / (2.0 * M_PI * kWidth * kWidth);
      }
      const double weight = std::exp(likelihood->log_likelihood(k, x)) / density;
      sum += weight / kDraws;
      squares += weight * weight / kDraws;
    }
    const double error = std::sqrt((squares - sum * sum) / kDraws);
    EXPECT_NEAR(sum, std::exp(p.log_evidence[static_cast<std::size_t>(k)]), kHardSigmas * error)
        << k;
  }
}

// From wider bananas: x1 ~ N(0, 1.1²), x2 ~ N(x1², (1.1 width)²). The weights are bounded.
TEST(HardProblems, BananasAgreeWithImportanceSampling) {
  for (const auto& [name, width] :
       {std::pair{"banana, 2-d", 0.01}, std::pair{"bananas, 6-d", 0.01},
        std::pair{"bananas, 2-d, 1e-3 wide", 1e-3}, std::pair{"bananas, 2-d, 1e-4 wide", 1e-4}}) {
    const HardProblem& p = hard_problem(name);
    const auto likelihood = p.problem.likelihood();
    constexpr double kWider = 1.1;
    std::vector<double> x(static_cast<std::size_t>(p.dimension));
    constexpr int kDraws = 100000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      base::Random random(3, x.size(), static_cast<std::uint64_t>(i), base::Purpose::test);
      double log_density = 0.0, log_prior = 0.0;
      bool inside = true;
      for (std::size_t j = 0; j < x.size(); j += 2) {
        const double a = random.normal(), b = random.normal();
        x[j] = kWider * a;
        x[j + 1] = x[j] * x[j] + kWider * width * b;
        log_density -= 0.5 * (a * a + b * b) + std::log(2.0 * M_PI * kWider * kWider * width);
        log_prior -= std::log(8.0 * 11.0);
        inside = inside && std::fabs(x[j]) < 4.0 && x[j + 1] > -1.0 && x[j + 1] < 10.0;
      }
      if (!inside) continue;
      const double weight = std::exp(likelihood->log_likelihood(1, x) + log_prior - log_density);
      sum += weight / kDraws;
      squares += weight * weight / kDraws;
    }
    const double error = std::sqrt((squares - sum * sum) / kDraws);
    EXPECT_NEAR(sum, std::exp(p.log_evidence[1]), kHardSigmas * error) << name;
    EXPECT_LT(error, 0.005);
  }
}

TEST(HardProblems, ChangePointHasABayesFactorNear75) {
  const HardProblem& p = hard_problem("change point, 16-d against 10-d");
  EXPECT_NEAR(p.probability[1] / p.probability[0], 75.0, 5.0);
}

// ∫ L p over the box of a problem of one or two parameters, by midpoints on a grid.
double quadrature(const HardProblem& p, int n) {
  const auto likelihood = p.problem.likelihood();
  const int d = p.dimension;
  const Prior& first = p.problem.space.prior(1, 0);
  const Prior& second = p.problem.space.prior(1, d - 1);
  double sum = 0.0;
  std::vector<double> x(static_cast<std::size_t>(d));
  for (int i = 0; i < n; ++i) {
    x[0] = first.lower() + (first.upper() - first.lower()) * (i + 0.5) / n;
    for (int j = 0; j < (d == 2 ? n : 1); ++j) {
      if (d == 2) x[1] = second.lower() + (second.upper() - second.lower()) * (j + 0.5) / n;
      sum += std::exp(likelihood->log_likelihood(1, x));
    }
  }
  return std::log(sum) - d * std::log(n);
}

TEST(HardProblems, AnswersInOneAndTwoDimensionsAgreeWithQuadrature) {
  for (const auto& [name, n, tolerance] :
       {std::tuple{"equal modes, 2-d", 1000, 1e-9}, std::tuple{"a mode of 3 %, 2-d", 1000, 1e-9},
        std::tuple{"log-gamma mixture, 2-d", 1000, 1e-6}, std::tuple{"Cauchy, 1-d", 40000, 1e-6},
        std::tuple{"Cauchy, 2-d", 4000, 1e-4}, std::tuple{"spike, 1-d", 4000000, 1e-9},
        std::tuple{"exponential edges, 1-d", 4000000, 1e-3},
        std::tuple{"widths 1000:1, 1-d", 200000, 1e-9}, std::tuple{"banana, 2-d", 4000, 1e-4},
        std::tuple{"correlated, 2-d", 4000, 1e-6}}) {
    const HardProblem& p = hard_problem(name);
    EXPECT_NEAR(quadrature(p, n), p.log_evidence[1], tolerance) << name;
  }
}

TEST(HardProblems, RadiataPineHasThePublishedBayesFactor) {
  SKIP_WITHOUT_SHARED("radiata");
  const auto folder = kShared / "validation" / "radiata";
  const auto exact = nlohmann::json::parse(std::ifstream(folder / "exact.json"));
  const HardProblem p = radiata_problem(folder.string());
  for (std::size_t m = 0; m < 2; ++m)
    EXPECT_NEAR(p.log_evidence[m], exact["log_evidence"][m].get<double>(), 2e-6);
  const double factor = exact["bayes_factor_21"];
  EXPECT_NEAR(p.probability[1] / p.probability[0], factor, 1e-4 * factor);
}

}  // namespace
}  // namespace wheeltap::inference
