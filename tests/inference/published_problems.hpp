// Problems whose posteriors and evidences are published or known exactly: coal-mining disasters and
// Hald's regressions. Their data are outside the repository.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "base/eigen_solvers.hpp"
#include "inference/model/target.hpp"
#include "inference/moves/between_models/transformation.hpp"

namespace wheeltap::inference {

inline const std::filesystem::path kShared = WHEELTAP_SHARED_DIR;

#define SKIP_WITHOUT_SHARED(folder)                                \
  if (!std::filesystem::exists(kShared / "validation" / (folder))) \
  GTEST_SKIP() << "the validation set '" << (folder) << "' is not beside this checkout"

inline constexpr double kCoalDays = 40907.0;  ///< length of the record

inline std::vector<double> coal_days() {
  std::ifstream file(kShared / "validation" / "coal" / "disaster_days.csv");
  std::string line;
  std::getline(file, line);
  std::vector<double> days;
  for (double day = 0.0; file >> day;) days.push_back(day);
  return days;
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

inline Problem coal_problem(const std::vector<double>& days, double length, int k_min, int k_max) {
  std::vector<ModelSpace::Counts> counts;
  for (int k = k_min; k <= k_max; ++k) {
    counts.push_back({{k}, std::exp(k * std::log(3.0) - std::lgamma(k + 1.0))});
  }
  const Gamma height{1.0, 1.0 / 200.0};
  // A birth keeps the height before the new change point. This user-defined map keeps the height
  // after it, at the start of the record: (h_0, …) and (s, h) ↔ h_0' = h, first change (s, h_0), …
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

// Hald: y = α + X β + ε, p(α, σ²) ∝ 1/σ² common to all models, Zellner's prior β | σ² ~ N(0, g σ²
// (XᵀX)⁻¹). After integration over α and σ², the likelihood of β given the subset is a multivariate
// t. The engine samples b, which is β scaled to a standard normal prior; ln σ² is a parameter
// common to all models.
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
  // ∫∫ N(y; α + √g σ Q b, σ²) dα dσ²/σ²: with a = Qᵀy and s = yᵀy, quadrature over t = 1/σ gives
  // the integral over σ > 0 of σ^-(n-1) exp(-½ |y/σ - √g Q b|²) 2 dσ/σ.
  double log_likelihood(int model, std::span<const double> b) override {
    const Eigen::MatrixXd& q = basis_[static_cast<std::size_t>(model)];
    const Eigen::Map<const Eigen::VectorXd> z(b.data(), static_cast<Eigen::Index>(b.size()));
    const double ss = y_.squaredNorm();
    const double cross = b.empty() ? 0.0 : std::sqrt(n_) * (q.transpose() * y_).dot(z);
    const double bb = b.empty() ? 0.0 : n_ * z.squaredNorm();
    // ∫ t^(n-2) exp(-½ (s t² - 2 c t + g b²)) dt, t = 1/σ, by Simpson's rule about the maximum.
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

inline Problem hald_problem() {
  std::ifstream file(kShared / "validation" / "hald" / "cement.csv");
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
  return {.space = ModelSpace::of_models(parameters, models),
          .likelihood = [=] { return std::make_unique<Regression>(x, y, subsets); }};
}

}  // namespace wheeltap::inference
