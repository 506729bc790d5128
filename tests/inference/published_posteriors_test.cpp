// Posteriors known exactly: Green's coal-mining change points, the Hald regressions, and mixture
// targets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/eigen_solvers.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "tests/inference/published_problems.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kPublishedSigmas = 4.9;
bool long_published_tests() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

// Mean and Monte Carlo standard error of an indicator over the models.
struct PublishedEstimate {
  double mean, error, iact;
};
template <typename Indicator>
PublishedEstimate estimate(const Posterior& posterior, Indicator&& of_model) {
  ChainsOf chains;
  double sum = 0.0, n = 0.0;
  for (const Chain& chain : posterior.chains) {
    auto& values = chains.emplace_back();
    for (const int m : chain.model) values.push_back(of_model(m));
    for (const double v : values) sum += v;
    n += static_cast<double>(values.size());
  }
  return {sum / n, mcse_mean(chains), n / ess_mean(chains)};
}

TEST(PublishedPosteriors, CoalMiningDisasters) {
  SKIP_WITHOUT_SHARED("coal");
  const auto folder = kShared / "validation" / "coal";
  const auto exact = nlohmann::json::parse(std::ifstream(folder / "exact.json"));
  const std::vector<double> days = coal_days();
  ASSERT_EQ(days.size(), exact["n"].get<std::size_t>());
  const Problem problem = coal_problem(days, exact["length_days"], 1, 6);

  const int seeds = long_published_tests() ? 10 : 1;
  double sum = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    Options options{.seed = static_cast<std::uint64_t>(seed)};
    if (long_published_tests()) {
      options.draws = 250000;
    } else {
      options.draws = 20000;
    }
    const Posterior posterior = reversible_jump(problem, options);
    double worst = 0.0;
    for (int m = 0; m < 6; ++m) {
      const double p = exact["exact_p_k_given_1_to_6"][static_cast<std::size_t>(m)];
      const PublishedEstimate e =
          estimate(posterior, [m](int model) { return model == m ? 1.0 : 0.0; });
      const double tolerance = long_published_tests() ? 0.005 : kPublishedSigmas * e.error;
      EXPECT_NEAR(e.mean, p, tolerance) << "seed " << seed << ", k = " << m + 1;
      worst = std::max(worst, std::abs(e.mean - p));
    }
    const PublishedEstimate k =
        estimate(posterior, [](int model) { return static_cast<double>(model); });
    const double calls =
        static_cast<double>(posterior.likelihood_evaluations - posterior.warmup_evaluations) /
        (static_cast<double>(posterior.draws) * options.chains);
    sum += k.iact * calls;
    std::printf(
        "coal, seed %d: largest error %.4f, IACT of k %.1f calls, pilot %ld of %ld calls, %.1f s\n",
        seed, worst, k.iact * calls, posterior.warmup_evaluations, posterior.likelihood_evaluations,
        posterior.wall_seconds);
  }
  // Of one short run it is known to a factor of two: 33 to 91 over six seeds.
  EXPECT_LT(sum / seeds, long_published_tests() ? 76.0 : 152.0)
      << "AutoMix: 38 sweeps of two calls";
}

TEST(PublishedPosteriors, HaldRegressions) {
  SKIP_WITHOUT_SHARED("hald");
  const auto folder = kShared / "validation" / "hald";
  const auto exact = nlohmann::json::parse(std::ifstream(folder / "exact.json"));
  const Problem problem = hald_problem();
  const Posterior posterior =
      reversible_jump(problem, {.draws = long_published_tests() ? 200000 : 15000});
  const auto expect = [&](const PublishedEstimate& e, double p, const std::string& what) {
    EXPECT_NEAR(e.mean, p, long_published_tests() ? 0.005 : kPublishedSigmas * e.error + 1e-4)
        << what;
  };
  for (int m = 0; m < 16; ++m) {
    const std::string& name = problem.space[m].name;
    expect(estimate(posterior, [m](int model) { return model == m ? 1.0 : 0.0; }),
           exact["probability"][name], name);
  }
  for (int j = 0; j < 4; ++j) {
    expect(estimate(posterior, [j](int model) { return model >> j & 1; }),
           exact["inclusion"]["x" + std::to_string(j + 1)],
           "inclusion of x" + std::to_string(j + 1));
  }
}

// Targets that are mixtures of normals in each dimension, with a chosen probability for each model:
// the likelihood is that density over the prior's.
class MixtureTarget : public Likelihood {
 public:
  explicit MixtureTarget(std::vector<double> probabilities)
      : probabilities_(std::move(probabilities)) {}
  double log_likelihood(int model, std::span<const double> x) override {
    // Two modes per dimension, at (-1)^j (1.5, …) with unequal weights and widths.
    double first = std::log(0.35), second = std::log(0.65), prior = 0.0;
    for (std::size_t j = 0; j < x.size(); ++j) {
      const double sign = j % 2 == 0 ? 1.0 : -1.0;
      const double a = (x[j] - 1.5 * sign) / 0.3, b = (x[j] + 1.0 * sign) / 0.5;
      first -= 0.5 * a * a + std::log(0.3);
      second -= 0.5 * b * b + std::log(0.5);
      prior -= 0.5 * x[j] * x[j] / 9.0 + std::log(3.0);
    }
    const double top = std::max(first, second);
    return std::log(probabilities_[static_cast<std::size_t>(model)]) + top +
           std::log(std::exp(first - top) + std::exp(second - top)) - prior;
  }

 private:
  std::vector<double> probabilities_;
};

void check_mixture_target(const std::vector<double>& probabilities) {
  std::vector<Parameter> parameters;
  std::vector<ModelSpace::ListedModel> models;
  std::vector<std::string> names;
  for (std::size_t d = 1; d <= probabilities.size(); ++d) {
    names.push_back("x" + std::to_string(d));
    parameters.push_back({names.back(), Normal{0.0, 3.0}});
    models.push_back({.name = std::to_string(d), .weight = 1.0, .parameters = names});
  }
  const Problem problem{.space = ModelSpace::of_models(parameters, models), .likelihood = [&] {
                          return std::make_unique<MixtureTarget>(probabilities);
                        }};
  const Posterior posterior =
      reversible_jump(problem, {.draws = long_published_tests() ? 100000 : 20000});
  for (std::size_t m = 0; m < probabilities.size(); ++m) {
    const PublishedEstimate e =
        estimate(posterior, [m](int model) { return model == static_cast<int>(m) ? 1.0 : 0.0; });
    EXPECT_NEAR(e.mean, probabilities[m],
                long_published_tests() ? 0.005 : kPublishedSigmas * e.error)
        << "dimension " << m + 1;
    EXPECT_LT(e.error, 0.005);
  }
}

TEST(PublishedPosteriors, MixtureTargetsOfOneAndTwoDimensions) {
  check_mixture_target({0.3, 0.7});
}

TEST(PublishedPosteriors, MixtureTargetsOfOneToFiveDimensions) {
  check_mixture_target({0.5, 0.25, 0.125, 0.0625, 0.0625});
}

}  // namespace
}  // namespace wheeltap::inference
