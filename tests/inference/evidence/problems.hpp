// Models whose evidence is known in closed form or by one-dimensional quadrature.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "base/eigen_solvers.hpp"
#include "inference/model/target.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {

/// A likelihood that is a function of the parameters.
class FunctionLikelihood : public Likelihood {
 public:
  using Function = std::function<double(int, std::span<const double>)>;
  explicit FunctionLikelihood(Function f) : f_(std::move(f)) {}
  double log_likelihood(int model, std::span<const double> x) override { return f_(model, x); }

 private:
  Function f_;
};

struct Known {
  Problem problem;
  double log_evidence;
};

inline Problem one_model(std::vector<Parameter> parameters, FunctionLikelihood::Function f) {
  std::vector<std::string> names;
  for (const Parameter& p : parameters) names.push_back(p.name);
  return {.space = ModelSpace::of_models(std::move(parameters), {{"only", 1.0, names}}),
          .likelihood = [f] { return std::make_unique<FunctionLikelihood>(f); }};
}

/// y = A θ + ε, ε ~ N(0, σ² I), θ_j ~ N(1, τ²): y ~ N(A 1, σ² I + τ² A Aᵀ). The columns of A are
/// nearly parallel, so that the posterior is a ridge.
inline Known linear_gaussian(int d, int n = 30, double sigma = 0.5, double tau = 2.0) {
  base::Random random(42, 0, static_cast<std::uint64_t>(d), base::Purpose::test);
  Eigen::MatrixXd a(n, d);
  Eigen::VectorXd y(n);
  for (int i = 0; i < n; ++i) {
    const double common = random.normal();
    for (int j = 0; j < d; ++j) a(i, j) = common + 0.3 * random.normal();
  }
  for (int i = 0; i < n; ++i) y[i] = a.row(i).sum() * (1.0 + 0.5 * tau) + sigma * random.normal();
  std::vector<Parameter> parameters;
  for (int j = 0; j < d; ++j) parameters.push_back({"t" + std::to_string(j), Normal{1.0, tau}});
  const auto f = [=](int, std::span<const double> x) {
    const Eigen::VectorXd e = y - a * Eigen::Map<const Eigen::VectorXd>(x.data(), d);
    return -0.5 * e.squaredNorm() / (sigma * sigma) - n * (kLogSqrt2Pi + std::log(sigma));
  };
  const Eigen::MatrixXd s =
      sigma * sigma * Eigen::MatrixXd::Identity(n, n) + tau * tau * a * a.transpose();
  const Eigen::LLT<Eigen::MatrixXd> llt(s);
  const Eigen::VectorXd e = y - a * Eigen::VectorXd::Ones(d);
  const Eigen::MatrixXd factor = llt.matrixL();
  return {one_model(parameters, f),
          -0.5 * e.dot(llt.solve(e)) - n * kLogSqrt2Pi - factor.diagonal().array().log().sum()};
}

/// Two normal modes at ± m of weights ¼ and ¾ under θ ~ N(0, I): E[N(θ; ±m, s²)] = N(m; 0, 1 + s²)
/// per coordinate, for both modes.
inline Known two_narrow_modes(int d, double m = 1.0, double s = 0.05) {
  std::vector<Parameter> parameters;
  for (int j = 0; j < d; ++j) parameters.push_back({"t" + std::to_string(j), Normal{0.0, 1.0}});
  const auto f = [=](int, std::span<const double> x) {
    double left = 0.0, right = 0.0;
    for (const double v : x) {
      left -= 0.5 * (v + m) * (v + m) / (s * s);
      right -= 0.5 * (v - m) * (v - m) / (s * s);
    }
    return log_sum_exp(std::log(0.25) + left, std::log(0.75) + right) -
           d * (kLogSqrt2Pi + std::log(s));
  };
  const double variance = 1.0 + s * s;
  return {one_model(parameters, f),
          d * (-0.5 * m * m / variance - kLogSqrt2Pi - 0.5 * std::log(variance))};
}

/// k exchangeable components with a likelihood ∏ g(x_i), g(x) = e^{4 sin 2πx}, x ~ U(0, 1): Z =
/// I₀(4)^k.
inline Known exchangeable(int k) {
  const auto f = [](int, std::span<const double> x) {
    double sum = 0.0;
    for (const double v : x) sum += 4.0 * std::sin(2.0 * std::numbers::pi * v);
    return sum;
  };
  return {{.space = ModelSpace::of_components(
               {}, {{"site", "sites", {{"place", Uniform{0.0, 1.0}}}}}, {{{k}, 1.0}}),
           .likelihood = [f] { return std::make_unique<FunctionLikelihood>(f); }},
          k * std::log(std::cyl_bessel_i(0.0, 4.0))};
}

/// Zero outside a corner of the prior: θ uniform on the unit square, likelihood 1 where both exceed
/// 0.8.
inline Known corner() {
  const auto f = [](int, std::span<const double> x) {
    return x[0] > 0.8 && x[1] > 0.8 ? 0.0 : -std::numeric_limits<double>::infinity();
  };
  return {one_model({{"a", Uniform{0.0, 1.0}}, {"b", Uniform{0.0, 1.0}}}, f), std::log(0.04)};
}

/// Twenty observations of mean 0.5 and sd 1: is their mean 0 (model 0) or N(0, 1) (model 1)? BF₁₀
/// = 2.360070.
inline Problem nested_means() {
  const auto f = [](int, std::span<const double> x) {
    // The sufficient part: the scatter about the sample mean is common to both models.
    const double mu = x.empty() ? 0.0 : x[0], n = 20.0, mean = 0.5;
    return -0.5 * n * (mean - mu) * (mean - mu);
  };
  return {.space = ModelSpace::of_models({{"mu", Normal{0.0, 1.0}}},
                                         {{"null", 0.5, {}}, {"free", 0.5, {"mu"}}}),
          .likelihood = [f] { return std::make_unique<FunctionLikelihood>(f); }};
}

/// Impossible everywhere.
inline Problem never() {
  return one_model({{"a", Uniform{0.0, 1.0}}}, [](int, std::span<const double>) {
    return -std::numeric_limits<double>::infinity();
  });
}

/// Each value is a million nats above the one before, at any point: β increases so slowly that it
/// is far from 1 after a thousand stages.
inline Problem endless() {
  class Drifting : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double>) override { return value_ += 1e6; }

   private:
    double value_ = 0.0;
  };
  Problem problem = one_model({{"a", Uniform{0.0, 1.0}}}, nullptr);
  problem.likelihood = [] { return std::make_unique<Drifting>(); };
  return problem;
}

/// The parameter r of the logistic map y → r y (1 - y), with one step per ten samples. Information
/// on r grows exponentially with the record, and the posterior is rugged except for a needle at the
/// truth.
class LogisticMap final : public Likelihood {
 public:
  explicit LogisticMap(long samples) : samples_(samples) {}
  double log_likelihood(int, std::span<const double> x) override {
    double sum = 0.0, truth = 0.3, y = 0.3;
    for (long n = 0; n < samples_; ++n) {
      if (n % 10 == 0) {
        truth = kTruth * truth * (1.0 - truth);
        y = x[0] * y * (1.0 - y);
      }
      sum -= 0.5 * (truth - y) * (truth - y) / (kSigma * kSigma);
    }
    return sum;
  }
  static constexpr double kTruth = 3.8765, kSigma = 0.1, kLow = 3.6, kHigh = 4.0;

 private:
  long samples_;
};

inline Problem logistic_map(long samples) {
  return {
      .space = ModelSpace::of_models({{"r", Uniform{LogisticMap::kLow, LogisticMap::kHigh}}},
                                     {{"map", 1.0, {"r"}}}),
      .likelihood = [samples] { return std::make_unique<LogisticMap>(samples); },
      .samples = samples,
      .shortened = [](long first) { return std::make_shared<const Problem>(logistic_map(first)); }};
}

}  // namespace wheeltap::inference
