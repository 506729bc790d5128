// Noise model of numbered frequencies.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

/// Measured data: the lowest elastic natural frequencies.
struct FrequencyData {
  std::vector<double> frequencies_hz;  ///< NaN for modes not measured
  std::vector<double> sd_hz;           ///< empty if `cv` is inferred
  std::optional<double> cv;            ///< coefficient of variation, if the case gives a number
  std::optional<inference::Prior> cv_prior;
  double discrepancy_cv = 0.0;  ///< error of the beam model itself, in addition to the noise
  bool simulated = false;       ///< simulated from the case's truth
  std::string origin;           ///< description of the origin for the summary

  [[nodiscard]] int modes() const { return static_cast<int>(frequencies_hz.size()); }
  [[nodiscard]] int measured() const;
};

/// The noise model that likelihood, fit and replicates use. For mode i,
///
///   f_obs - f(θ) ~ N(0, sd_i²),   sd_i² = σ_i² + σ²_emulator,i(θ) + (discrepancy · f_obs,i)²,
///
/// with σ_i the measurement's sd, or cv · f_obs,i if the coefficient of variation is a parameter
/// (always the first parameter). For a mode that was not measured, f(θ) replaces f_obs.
class NoiseModel {
 public:
  explicit NoiseModel(const FrequencyData& data) : data_(&data) {}

  /// The coefficient of variation in the parameter vector; 0 if it is not a parameter.
  [[nodiscard]] double cv(std::span<const double> x) const { return data_->cv_prior ? x[0] : 0.0; }
  /// Sd [Hz] of a measured mode (0-based). `emulator_variance` [Hz²].
  [[nodiscard]] double sd(std::size_t mode, double cv, double emulator_variance) const {
    return sd_about(mode, data_->frequencies_hz[mode], cv, emulator_variance);
  }
  /// Sd [Hz] of a replicate of any mode that is predicted at `predicted` [Hz]; NaN if the mode was
  /// not measured and its accuracy is unknown.
  [[nodiscard]] double replicate_sd(std::size_t mode, double predicted, double cv,
                                    double emulator_variance) const;
  /// Returns Σ over measured modes of -½ r² - ln(sd √2π), r = (f_obs - f) / sd; appends each r to
  /// `residuals`.
  [[nodiscard]] double log_likelihood(std::span<const double> predicted,
                                      std::span<const double> emulator_variance, double cv,
                                      std::vector<double>& residuals) const;

 private:
  [[nodiscard]] double sd_about(std::size_t mode, double frequency, double cv,
                                double emulator_variance) const;
  const FrequencyData* data_;
};

}  // namespace wheeltap::identification
