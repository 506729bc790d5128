// Interface of an observation: data of one kind, and their noise.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "identification/structural/forward/forward_model.hpp"
#include "identification/structural/likelihood/noise_model.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// Data of one kind. Given the prediction and noise parameters, these data are independent of all
/// other data. Immutable and shared by threads.
class Observation {
 public:
  virtual ~Observation() = default;

  /// Unknown noise parameters.
  [[nodiscard]] virtual std::vector<inference::Parameter> parameters() const { return {}; }
  /// Returns ln p(data | prediction, noise), with all normalising constants. `noise` has the values
  /// of the unknown noise parameters. `predicted` has frequencies or modes, as the problem's first
  /// observation requires. Every observation may append standardised residuals to `out`; only the
  /// first observation may change other members of `out`.
  virtual double log_density(const Prediction& predicted, std::span<const double> noise,
                             inference::Evaluation& out) const = 0;
};

/// Measured frequencies of the lowest elastic modes, identified by mode number; see NoiseModel.
class FrequencyObservation final : public Observation {
 public:
  explicit FrequencyObservation(FrequencyData data) : data_(std::move(data)) {}

  [[nodiscard]] const FrequencyData& data() const { return data_; }
  [[nodiscard]] std::vector<inference::Parameter> parameters() const override {
    if (!data_.cv_prior) return {};
    return {{"cov", *data_.cv_prior}};
  }
  double log_density(const Prediction& predicted, std::span<const double> noise,
                     inference::Evaluation& out) const override {
    const double cv = data_.cv_prior ? noise[0] : 0.0;
    out.noise_scale = data_.cv_prior ? cv : 1.0;
    out.prediction = predicted.frequencies_hz;
    return NoiseModel(data_).log_likelihood(predicted.frequencies_hz, predicted.error_variance, cv,
                                            out.residuals);
  }

 private:
  FrequencyData data_;
};

}  // namespace wheeltap::identification
