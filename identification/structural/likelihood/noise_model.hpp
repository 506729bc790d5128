// Measured frequencies, and how far from the model's they may be.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::identification {

/// What was measured: the lowest elastic natural frequencies.
struct FrequencyData {
  std::vector<double> frequencies_hz;  ///< NaN where a mode was not measured
  std::vector<double> sd_hz;           ///< empty where `cv` is inferred
  std::optional<double> cv;            ///< coefficient of variation where the case gives a number
  std::optional<inference::Prior> cv_prior;
  double discrepancy_cv = 0.0;  ///< of what the beam model itself leaves out, beside the noise
  bool simulated = false;       ///< made from the case's truth
  std::string origin;           ///< in words, for the summary

  [[nodiscard]] int modes() const { return static_cast<int>(frequencies_hz.size()); }
  [[nodiscard]] int measured() const;
};

/// The one noise model of likelihood, fit and replicates. For mode i,
///
///   f_obs - f(θ) ~ N(0, sd_i²),   sd_i² = σ_i² + σ²_emulator,i(θ) + (discrepancy · f_obs,i)²,
///
/// σ_i the measurement's sd, cv · f_obs,i where its coefficient of variation is a parameter (the
/// first of every model). Where a mode was not measured, f(θ) takes the place of f_obs.
class NoiseModel {
 public:
  explicit NoiseModel(const FrequencyData& data) : data_(&data) {}

  /// The coefficient of variation that the parameter vector holds; 0 where it is none.
  [[nodiscard]] double cv(std::span<const double> x) const { return data_->cv_prior ? x[0] : 0.0; }
  /// sd [Hz] of a measured mode (0-based). `emulator_variance` [Hz²].
  [[nodiscard]] double sd(std::size_t mode, double cv, double emulator_variance) const {
    return sd_about(mode, data_->frequencies_hz[mode], cv, emulator_variance);
  }
  /// sd [Hz] of a replicate of any mode that the model predicts at `predicted` [Hz]; NaN where
  /// nothing says how exactly an unmeasured mode would be known.
  [[nodiscard]] double replicate_sd(std::size_t mode, double predicted, double cv,
                                    double emulator_variance) const;
  /// Σ over measured modes of -½ r² - ln(sd √2π), r = (f_obs - f) / sd; appends each r to
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
