// Small problems with the features of a damage problem, at the cost of a few multiplications.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "inference/model/target.hpp"

namespace wheeltap::inference::toy {

inline constexpr int kSensors = 6;
inline constexpr double kNoise = 0.4;

/// y_i = Σ_components a · sin((i + 1) π x), a bump at x observed by a few modes. Locations x and 1
/// - x are equal for odd modes only, so that the posterior is multimodal without being symmetric.
inline void predict(std::span<const double> components, std::span<double> y) {
  for (std::size_t i = 0; i < y.size(); ++i) {
    y[i] = 0.0;
    for (std::size_t c = 0; c + 1 < components.size(); c += 2) {
      y[i] += components[c + 1] *
              std::sin((static_cast<double>(i) + 1.0) * 3.14159265358979323846 * components[c]);
    }
  }
}

class BumpLikelihood : public Likelihood {
 public:
  /// `gain` multiplies the predictions: 1, except for an approximation that is wrong on purpose.
  explicit BumpLikelihood(std::vector<double> data, double gain = 1.0)
      : data_(std::move(data)), gain_(gain), y_(data_.size()), r_(y_) {}

  double log_likelihood(int, std::span<const double> x) override {
    predict(x, y_);
    double sum = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i) {
      y_[i] *= gain_;
      r_[i] = (data_[i] - y_[i]) / kNoise;
      sum -= 0.5 * r_[i] * r_[i] + std::log(kNoise) + 0.91893853320467274178;
    }
    return sum;
  }
  void evaluate(double, int model, std::span<const double> x, Evaluation& out) override {
    out = {.log_likelihood = log_likelihood(model, x), .prediction = y_, .residuals = r_};
  }

 private:
  std::vector<double> data_;
  double gain_;
  std::vector<double> y_, r_;
};

/// 0 to k_max bumps, x ~ Beta(2, 3) (not uniform, so that a missing Jacobian shows), a ~ Gamma(2,
/// 0.5).
inline ModelSpace bump_space(const std::vector<double>& weights) {
  std::vector<ModelSpace::Counts> counts;
  for (std::size_t k = 0; k < weights.size(); ++k)
    counts.push_back({{static_cast<int>(k)}, weights[k]});
  return ModelSpace::of_components(
      {}, {{"bump", "bumps", {{"location", Beta{2.0, 3.0}}, {"height", Gamma{2.0, 0.5}}}}}, counts);
}

inline Problem bump_problem(std::vector<double> data, const std::vector<double>& weights) {
  return {.space = bump_space(weights),
          .likelihood = [data] { return std::make_unique<BumpLikelihood>(data); },
          .reflections = {{.kind = 0, .parameter = 0, .center = 0.5}}};
}

/// At most 3 bumps for data of one, without two of the sensors.
inline Problem bumps() {
  std::vector<double> data(kSensors);
  predict(std::vector<double>{0.3, 1.2}, data);
  data[1] += 0.3;
  data[4] -= 0.4;
  return bump_problem(data, {1, 1, 1, 1});
}

/// bump_problem with proposals screened by an approximate likelihood that underestimates every
/// bump.
inline Problem screened_bump_problem(std::vector<double> data, const std::vector<double>& weights) {
  Problem problem = bump_problem(data, weights);
  problem.screen = [data] { return std::make_unique<BumpLikelihood>(data, 0.7); };
  return problem;
}

}  // namespace wheeltap::inference::toy
