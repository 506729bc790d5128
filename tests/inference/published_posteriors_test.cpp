// Posteriors known exactly: Green's coal-mining change points, the Hald regressions, and mixture
// targets.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "inference/diagnostics.hpp"
#include "inference/moves/transformation.hpp"
#include "inference/reversible_jump.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kSigmas = 4.9;
const std::filesystem::path kShared = WHEELTAP_SHARED_DIR;

bool long_tests() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

#define SKIP_WITHOUT_SHARED(folder)                                \
  if (!std::filesystem::exists(kShared / "validation" / (folder))) \
  GTEST_SKIP() << "the validation set '" << (folder) << "' is not beside this checkout"

// Mean and Monte Carlo standard error of an indicator over the models.
struct Estimate {
  double mean, error, iact;
};
template <typename Indicator>
Estimate estimate(const Posterior& posterior, Indicator&& of_model) {
  ChainsOf chains;
  double sum = 0.0, n = 0.0;
  for (const Chain& chain : posterior.chains) {
    auto& values = chains.emplace_back();
    for (const int m : chain.model) values.push_back(of_model(m));
    for (const double v : values) sum += v;
    n += static_cast<double>(values.size());
  }
  return {sum / n, mcse_mean(chains), iact(chains)};
}

// Green (1995): k change points in the rate of a Poisson process; positions are the even-numbered
// order statistics of 2k + 1 uniforms on (0, L), heights Gamma(1, rate 200 days). A component is a
// change point with the height that follows it.
class Coal : public Likelihood {
 public:
  Coal(std::vector<double> days, double length) : days_(std::move(days)), length_(length) {}
  double log_likelihood(int, std::span<const double> x) override {
    double height = x[0], from = 0.0, sum = 0.0;
    auto event = days_.begin();
    for (std::size_t c = 1; c <= x.size(); c += 2) {
      const double to = c < x.size() ? x[c] : length_;
      const auto last = std::upper_bound(event, days_.end(), to);
      sum += static_cast<double>(last - event) * std::log(height) - height * (to - from);
      event = last;
      from = to;
      if (c < x.size()) height = x[c + 1];
    }
    return sum;
  }

 private:
  std::vector<double> days_;
  double length_;
};

Problem coal_problem(const std::vector<double>& days, double length, int k_min, int k_max) {
  std::vector<ModelSpace::Counts> counts;
  for (int k = k_min; k <= k_max; ++k) {
    counts.push_back({{k}, std::exp(k * std::log(3.0) - std::lgamma(k + 1.0))});
  }
  const Gamma height{1.0, 1.0 / 200.0};
  // A birth leaves the height before the new change point alone. This user-made map leaves the one
  // after it alone instead, at the start of the record: (h_0, …) and (s, h) ↔ h_0' = h, first
  // change (s, h_0), …
  std::vector<NamedMove> first_interval;
  const auto space = std::make_shared<ModelSpace>(ModelSpace::of_components(
      {{"height[0]", height}},
      {{"change", "changes", {{"day", Uniform{0.0, length}}, {"height", height}}}}, counts));
  for (int m = 0; m + 1 < space->size(); ++m) {
    first_interval.push_back(
        {"change at the start", [=]() -> std::unique_ptr<Move> {
           return std::make_unique<Transformation>(
               *space, Transformation::Definition{
                           .lower = m,
                           .upper = m + 1,
                           .lower_auxiliaries = {Uniform{0.0, length}, height},
                           .upper_auxiliaries = {},
                           .forward =
                               [](std::span<const double> from, std::span<double> to) {
                                 const std::size_t n = from.size();
                                 to[0] = from[n - 1];
                                 to[1] = from[n - 2];
                                 std::copy(from.begin(), from.end() - 2, to.begin() + 2);
                                 return 0.0;
                               },
                           .inverse =
                               [](std::span<const double> from, std::span<double> to) {
                                 const std::size_t n = from.size();
                                 std::copy(from.begin() + 2, from.end(), to.begin());
                                 to[n - 1] = from[0];
                                 to[n - 2] = from[1];
                                 return 0.0;
                               }});
         }});
  }
  return {.space = ModelSpace::of_components(
              {{"height[0]", height}},
              {{"change", "changes", {{"day", Uniform{0.0, length}}, {"height", height}}}}, counts),
          .likelihood = [=] { return std::make_unique<Coal>(days, length); },
          // Even order statistics: (2k+1)! ∏ gaps / L^(2k+1), against k! / L^k of ordered uniforms.
          .log_prior_factor =
              [length](int, std::span<const double> x) {
                const double k = static_cast<double>(x.size() / 2);
                double sum = std::lgamma(2.0 * k + 2.0) - std::lgamma(k + 1.0);
                double from = 0.0;
                for (std::size_t c = 1; c <= x.size(); c += 2) {
                  const double to = c < x.size() ? x[c] : length;
                  sum += std::log((to - from) / length);
                  from = to;
                }
                return sum;
              },
          .moves = first_interval};
}

TEST(PublishedPosteriors, CoalMiningDisasters) {
  SKIP_WITHOUT_SHARED("coal");
  const auto folder = kShared / "validation" / "coal";
  const auto exact = nlohmann::json::parse(std::ifstream(folder / "exact.json"));
  std::ifstream file(folder / "disaster_days.csv");
  std::string line;
  std::getline(file, line);
  std::vector<double> days;
  for (double day = 0.0; file >> day;) days.push_back(day);
  ASSERT_EQ(days.size(), exact["n"].get<std::size_t>());
  const Problem problem = coal_problem(days, exact["length_days"], 1, 6);

  const int seeds = long_tests() ? 10 : 1;
  for (int seed = 1; seed <= seeds; ++seed) {
    Options options{.seed = static_cast<std::uint64_t>(seed)};
    if (long_tests()) {
      options.draws = 250000;
    } else {
      options.draws = 20000;
    }
    const Posterior posterior = reversible_jump(problem, options);
    double worst = 0.0;
    for (int m = 0; m < 6; ++m) {
      const double p = exact["exact_p_k_given_1_to_6"][static_cast<std::size_t>(m)];
      const Estimate e = estimate(posterior, [m](int model) { return model == m ? 1.0 : 0.0; });
      const double tolerance = long_tests() ? 0.005 : kSigmas * e.error;
      EXPECT_NEAR(e.mean, p, tolerance) << "seed " << seed << ", k = " << m + 1;
      worst = std::max(worst, std::abs(e.mean - p));
    }
    const Estimate k = estimate(posterior, [](int model) { return static_cast<double>(model); });
    const double calls =
        static_cast<double>(posterior.likelihood_evaluations - posterior.warmup_evaluations) /
        (static_cast<double>(posterior.draws) * options.chains);
    EXPECT_LT(k.iact * calls, 76.0) << "AutoMix: 38 sweeps of two calls";
    std::printf(
        "coal, seed %d: largest error %.4f, IACT of k %.1f calls, pilot %ld of %ld calls, %.1f s\n",
        seed, worst, k.iact * calls, posterior.warmup_evaluations, posterior.likelihood_evaluations,
        posterior.wall_seconds);
  }
}

// Hald: y = α + X β + ε, p(α, σ²) ∝ 1/σ² common to all models, Zellner's prior β | σ² ~ N(0, g σ²
// (XᵀX)⁻¹). With α integrated out, and then σ² too, the likelihood of β given the subset is a
// multivariate t; the engine samples β in coordinates b = β / (√g σ̂) … here b is what a subset's β
// is, scaled so that its prior is a standard normal, with ln σ² as one more parameter common to
// all.
class Regression : public Likelihood {
 public:
  Regression(const Eigen::MatrixXd& x, const Eigen::VectorXd& y,
             const std::vector<std::vector<int>>& subsets)
      : y_(y.array() - y.mean()), n_(static_cast<double>(y.size())) {
    for (const auto& subset : subsets) {
      Eigen::MatrixXd part(x.rows(), static_cast<Eigen::Index>(subset.size()));
      for (std::size_t j = 0; j < subset.size(); ++j) {
        part.col(static_cast<Eigen::Index>(j)) = x.col(subset[j]).array() - x.col(subset[j]).mean();
      }
      if (subset.empty()) {
        basis_.emplace_back(x.rows(), 0);
        continue;
      }
      // β = √g σ R⁻¹ b with XᵀX = RᵀR, so that X β = √g σ Q b and b ~ N(0, I).
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(part);
      basis_.push_back(qr.householderQ() * Eigen::MatrixXd::Identity(x.rows(), part.cols()));
    }
  }
  // ∫∫ N(y; α + √g σ Q b, σ²) dα dσ²/σ²: with a = Qᵀy and s = yᵀy the integral over σ > 0 of
  // σ^-(n-1) exp(-½ |y/σ - √g Q b|²) 2 dσ/σ is done by quadrature over t = 1/σ.
  double log_likelihood(int model, std::span<const double> b) override {
    const Eigen::MatrixXd& q = basis_[static_cast<std::size_t>(model)];
    const Eigen::Map<const Eigen::VectorXd> z(b.data(), static_cast<Eigen::Index>(b.size()));
    const double ss = y_.squaredNorm();
    const double cross = b.empty() ? 0.0 : std::sqrt(n_) * (q.transpose() * y_).dot(z);
    const double bb = b.empty() ? 0.0 : n_ * z.squaredNorm();
    // ∫ t^(n-2) exp(-½ (s t² - 2 c t + g b²)) dt, t = 1/σ: a parabola around its top, Simpson's
    // rule.
    const double m = n_ - 2.0;
    const double top = (cross + std::sqrt(cross * cross + 4.0 * ss * m)) / (2.0 * ss);
    const double width = 1.0 / std::sqrt(ss + m / (top * top));
    const auto log_f = [&](double t) {
      return m * std::log(t) - 0.5 * (ss * t * t - 2.0 * cross * t + bb);
    };
    const double peak = log_f(top);
    const double low = std::max(top - 12.0 * width, 1e-12), high = top + 12.0 * width;
    constexpr int kSteps = 120;
    double sum = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      const double t = low + (high - low) * i / kSteps;
      sum += (i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * std::exp(log_f(t) - peak);
    }
    return peak + std::log(sum * (high - low) / (3.0 * kSteps));
  }

 private:
  Eigen::VectorXd y_;
  double n_;
  std::vector<Eigen::MatrixXd> basis_;
};

TEST(PublishedPosteriors, HaldRegressions) {
  SKIP_WITHOUT_SHARED("hald");
  const auto folder = kShared / "validation" / "hald";
  const auto exact = nlohmann::json::parse(std::ifstream(folder / "exact.json"));
  std::ifstream file(folder / "cement.csv");
  std::string line;
  std::getline(file, line);
  Eigen::MatrixXd x(13, 4);
  Eigen::VectorXd y(13);
  for (Eigen::Index i = 0; i < 13; ++i) {
    char comma = 0;
    for (Eigen::Index j = 0; j < 4; ++j) file >> x(i, j) >> comma;
    file >> y[i];
  }
  std::vector<std::vector<int>> subsets;
  std::vector<ModelSpace::ListedModel> models;
  std::vector<Parameter> parameters;
  for (int j = 1; j <= 4; ++j) parameters.push_back({"b" + std::to_string(j), Normal{0.0, 1.0}});
  for (int bits = 0; bits < 16; ++bits) {
    std::vector<int>& subset = subsets.emplace_back();
    ModelSpace::ListedModel model{.name = "{", .weight = 1.0, .parameters = {}};
    for (int j = 0; j < 4; ++j) {
      if ((bits >> j & 1) == 0) continue;
      subset.push_back(j);
      model.name += (subset.size() > 1 ? "," : "") + std::to_string(j + 1);
      model.parameters.push_back("b" + std::to_string(subset.size()));
    }
    model.name += "}";
    models.push_back(std::move(model));
  }
  const Problem problem{.space = ModelSpace::of_models(parameters, models),
                        .likelihood = [&] { return std::make_unique<Regression>(x, y, subsets); }};
  const Posterior posterior = reversible_jump(problem, {.draws = long_tests() ? 200000 : 15000});
  const auto expect = [&](const Estimate& e, double p, const std::string& what) {
    EXPECT_NEAR(e.mean, p, long_tests() ? 0.005 : kSigmas * e.error + 1e-4) << what;
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
    // Two modes a dimension, at (-1)^j (1.5, …) with unequal weights and widths.
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
  const Posterior posterior = reversible_jump(problem, {.draws = long_tests() ? 100000 : 20000});
  for (std::size_t m = 0; m < probabilities.size(); ++m) {
    const Estimate e =
        estimate(posterior, [m](int model) { return model == static_cast<int>(m) ? 1.0 : 0.0; });
    EXPECT_NEAR(e.mean, probabilities[m], long_tests() ? 0.005 : kSigmas * e.error)
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
