// As in hard_problems.cpp, each problem is a density g of mass 1 as likelihood: ln L = c + ln g -
// ln p under the prior p, so that Z = e^c, against a model without parameters and with Z = 1.
#include "tests/inference/study_problems.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>

#include "base/constants.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

using Point = std::span<const double>;
using LogDensity = std::function<double(Point)>;

double normal_log_density(double x, double mean, double sd) {
  const double r = (x - mean) / sd;
  return -0.5 * r * r - std::log(sd) - kLogSqrt2Pi;
}

// Log likelihood of the density, and of the model without parameters.
class DensityLikelihood : public Likelihood {
 public:
  explicit DensityLikelihood(LogDensity log) : log_(std::move(log)) {}
  double log_likelihood(int model, Point x) override { return model == 0 ? 0.0 : log_(x); }

 private:
  LogDensity log_;
};

// The density under independent priors, against nothing, with probability ½ each. All mass must lie
// where the priors are positive.
HardProblem versus_nothing(const std::string& family, const LogDensity& log_density,
                           const std::vector<Prior>& priors) {
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (const Prior& prior : priors) {
    names.push_back("x" + std::to_string(names.size() + 1));
    parameters.push_back({names.back(), prior});
  }
  const auto d = static_cast<int>(priors.size());
  const LogDensity log_likelihood = [=](Point x) {
    double sum = log_density(x);
    for (std::size_t i = 0; i < x.size(); ++i) sum -= priors[i].log_density(x[i]);
    return sum;
  };
  return {.name = family + ", " + std::to_string(d) + "-d",
          .family = family,
          .dimension = d,
          .problem = {.space = ModelSpace::of_models(
                          parameters, {{"nothing", 1.0, {}}, {"density", 1.0, names}}),
                      .likelihood =
                          [=] { return std::make_unique<DensityLikelihood>(log_likelihood); }},
          .probability = {0.5, 0.5},
          .log_evidence = {0.0, 0.0},
          .draw = {},
          .hidden = {}};
}

std::vector<Prior> all(int d, const Prior& prior) {
  return std::vector<Prior>(static_cast<std::size_t>(d), prior);
}

// N(0.2, 0.1² I) under N(0, I).
HardProblem gaussian(int d) {
  return versus_nothing(
      "Gaussian",
      [](Point x) {
        double sum = 0.0;
        for (const double v : x) sum += normal_log_density(v, 0.2, 0.1);
        return sum;
      },
      all(d, Normal{0.0, 1.0}));
}

// x_1 ~ N(0, 1), x_i ~ N(0.9 x_{i-1}, 1 - 0.9²) under N(0, 3²).
HardProblem autoregressive(int d) {
  return versus_nothing(
      "AR(1)",
      [](Point x) {
        constexpr double kRho = 0.9;
        double sum = normal_log_density(x[0], 0.0, 1.0);
        for (std::size_t i = 1; i < x.size(); ++i)
          sum += normal_log_density(x[i], kRho * x[i - 1], std::sqrt(1.0 - kRho * kRho));
        return sum;
      },
      all(d, Normal{0.0, 3.0}));
}

// Neal's funnel, v ~ N(0, 1.5²), x_i ~ N(0, e^v), under v ~ N(0, 3²), x_i ~ N(0, 10²).
HardProblem normal_funnel(int d) {
  std::vector<Prior> priors = all(d, Normal{0.0, 10.0});
  priors[0] = Normal{0.0, 3.0};
  return versus_nothing(
      "funnel, normal priors",
      [](Point x) {
        double sum = normal_log_density(x[0], 0.0, 1.5);
        for (std::size_t i = 1; i < x.size(); ++i)
          sum += normal_log_density(x[i], 0.0, std::exp(0.5 * x[0]));
        return sum;
      },
      priors);
}

// Independent Student t with 3 degrees of freedom, truncated to |x| < 50: P = 1 - 2 (1 - F(50)).
HardProblem student(int d) {
  constexpr double kNu = 3.0, kBox = 50.0;
  // F(x) for ν = 3: ½ + (1/π) [atan(x/√3) + (x/√3)/(1 + x²/3)].
  const double u = kBox / std::sqrt(kNu);
  const double inside = 2.0 / std::acos(-1.0) * (std::atan(u) + u / (1.0 + u * u));
  const double log_norm = std::lgamma(2.0) - std::lgamma(1.5) -
                          0.5 * std::log(kNu * std::acos(-1.0)) - std::log(inside);
  return versus_nothing(
      "Student t",
      [=](Point x) {
        double sum = 0.0;
        for (const double v : x) sum += log_norm - 2.0 * std::log1p(v * v / kNu);
        return sum;
      },
      all(d, Uniform{-kBox, kBox}));
}

// x_1 ~ N(1, ½²) and five curved ridges x_i ~ N(x_j², 0.1²), from x_1 to x_2, x_4, x_6, from x_2 to
// x_3 and from x_4 to x_5 (a hybrid Rosenbrock density: Pagani, Wiegand & Nadarajah 2022).
HardProblem rosenbrock() {
  constexpr std::array<std::size_t, 6> kFrom = {0, 0, 1, 0, 3, 0};
  std::vector<Prior> priors = all(6, Normal{0.0, 5.0});
  priors[0] = Normal{0.0, 2.0};
  priors[2] = priors[4] = Normal{0.0, 20.0};
  return versus_nothing(
      "Rosenbrock",
      [=](Point x) {
        double sum = normal_log_density(x[0], 1.0, 0.5);
        for (std::size_t i = 1; i < x.size(); ++i)
          sum += normal_log_density(x[i], x[kFrom[i]] * x[kFrom[i]], 0.1);
        return sum;
      },
      priors);
}

// A shell: |x| ~ N(2, 0.1²) and a uniform direction. The density is N(|x|; 2, 0.1²) divided by the
// area 2 π^{d/2} |x|^{d-1} / Γ(d/2) of the sphere.
HardProblem halo(int d) {
  const double log_unit =
      std::log(2.0) + 0.5 * d * std::log(std::acos(-1.0)) - std::lgamma(0.5 * d);
  return versus_nothing(
      "halo",
      [=](Point x) {
        double squares = 0.0;
        for (const double v : x) squares += v * v;
        const double radius = std::sqrt(squares);
        return normal_log_density(radius, 2.0, 0.1) - log_unit - (d - 1) * std::log(radius);
      },
      all(d, Normal{0.0, 1.0}));
}

// ½ N(-½, 0.05²) + ½ N(½, 0.05²) in each coordinate, in |x| < 1: 2^d modes.
HardProblem two_in_each(int d) {
  return versus_nothing(
      "2^n modes",
      [](Point x) {
        double sum = 0.0;
        for (const double v : x)
          sum += log_sum_exp(normal_log_density(v, -0.5, 0.05), normal_log_density(v, 0.5, 0.05)) -
                 std::log(2.0);
        return sum;
      },
      all(d, Uniform{-1.0, 1.0}));
}

// Five values at 0.1, 0.3, …, 0.9 with widths of 0.02, in any order: 5! modes.
HardProblem labels() {
  std::vector<int> order(5);
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<int>> orders;
  do {
    orders.push_back(order);
  } while (std::ranges::next_permutation(order).found);
  return versus_nothing(
      "5! labels",
      [=](Point x) {
        double sum = -kInfinity;
        for (const std::vector<int>& to : orders) {
          double one = -std::log(static_cast<double>(orders.size()));
          for (std::size_t i = 0; i < x.size(); ++i)
            one += normal_log_density(x[i], 0.1 + 0.2 * to[i], 0.02);
          sum = log_sum_exp(sum, one);
        }
        return sum;
      },
      all(5, Uniform{0.0, 1.0}));
}

}  // namespace

const std::vector<HardProblem>& study_problems() {
  static const std::vector<HardProblem> list = [] {
    std::vector<HardProblem> out;
    for (const int d : {40, 50, 60}) {
      out.push_back(gaussian(d));
      out.push_back(autoregressive(d));
    }
    for (const int d : {10, 20, 30}) out.push_back(normal_funnel(d));
    for (const int d : {10, 20}) out.push_back(student(d));
    out.push_back(rosenbrock());
    out.push_back(halo(20));
    for (const int d : {6, 8}) out.push_back(two_in_each(d));
    out.push_back(labels());
    return out;
  }();
  return list;
}

}  // namespace wheeltap::inference
