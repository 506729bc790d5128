#include "identification/structural/likelihood/noise_model.hpp"

#include <algorithm>
#include <cmath>

namespace wheeltap::identification {

int FrequencyData::measured() const {
  return static_cast<int>(
      std::ranges::count_if(frequencies_hz, [](double f) { return !std::isnan(f); }));
}

double NoiseModel::sd_about(std::size_t mode, double frequency, double cv,
                            double emulator_variance) const {
  const double measured = data_->cv_prior ? cv * frequency : data_->sd_hz[mode];
  const double discrepancy = data_->discrepancy_cv * frequency;
  return std::sqrt(measured * measured + emulator_variance + discrepancy * discrepancy);
}

double NoiseModel::replicate_sd(std::size_t mode, double predicted, double cv,
                                double emulator_variance) const {
  const double observed = data_->frequencies_hz[mode];
  return sd_about(mode, std::isnan(observed) ? predicted : observed, cv, emulator_variance);
}

double NoiseModel::log_likelihood(std::span<const double> predicted,
                                  std::span<const double> emulator_variance, double cv,
                                  std::vector<double>& residuals) const {
  constexpr double kSqrtTwoPi = 2.5066282746310002;  // √(2π)
  double sum = 0.0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const double observed = data_->frequencies_hz[i];
    if (std::isnan(observed)) continue;
    const double sd_i = sd(i, cv, emulator_variance.empty() ? 0.0 : emulator_variance[i]);
    const double residual = (observed - predicted[i]) / sd_i;
    residuals.push_back(residual);
    sum -= 0.5 * residual * residual + std::log(sd_i * kSqrtTwoPi);
  }
  return sum;
}

}  // namespace wheeltap::identification
