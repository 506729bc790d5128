// Noise model of measured frequencies that are identified by mode number.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

/// Measured natural frequencies of the lowest elastic modes.
struct FrequencyData {
  std::vector<double> frequencies_hz;  ///< NaN for modes that were not measured
  std::vector<double> sd_hz;           ///< empty if `cv` is inferred
  std::optional<double> cv;            ///< sd divided by frequency, if the case gives a number
  std::optional<inference::Prior> cv_prior;
  double discrepancy_cv = 0.0;  ///< relative error of the beam model, added to the noise
  bool simulated = false;       ///< true: simulated with the true values of the case
  std::string origin;           ///< origin of the data, as in the summary

  [[nodiscard]] int modes() const { return static_cast<int>(frequencies_hz.size()); }
  [[nodiscard]] int measured() const;
};

/// The noise model that likelihood, fit and replicates use. For mode i,
///
///   f_obs - f(θ) ~ N(0, sd_i²),   sd_i² = σ_i² + σ²_emulator,i(θ) + (discrepancy · f_obs,i)²,
///
/// with σ_i the sd of the measurement, or cv · f_obs,i if the coefficient of variation cv is a
/// parameter (always the first parameter). For a mode that was not measured, f(θ) replaces f_obs.
class NoiseModel {
 public:
  explicit NoiseModel(const FrequencyData& data) : data_(&data) {}

  /// The coefficient of variation cv in the parameter vector; 0 if it is not a parameter.
  [[nodiscard]] double cv(std::span<const double> x) const { return data_->cv_prior ? x[0] : 0.0; }
  /// Sd [Hz] of a measured mode (from 0). `emulator_variance` is in Hz².
  [[nodiscard]] double sd(std::size_t mode, double cv, double emulator_variance) const {
    return sd_about(mode, data_->frequencies_hz[mode], cv, emulator_variance);
  }
  /// Sd [Hz] of replicated data of any mode whose prediction is `predicted` [Hz]; NaN if the mode
  /// was not measured and its sd is unknown.
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
