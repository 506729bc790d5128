// One kind of data, with its noise.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "identification/structural/forward/forward_model.hpp"
#include "identification/structural/likelihood/noise_model.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// Data of one kind, independent of all others given what the model predicts. Immutable: threads
/// share it.
class Observation {
 public:
  virtual ~Observation() = default;

  /// The unknown parameters of its noise.
  [[nodiscard]] virtual std::vector<inference::Parameter> parameters() const { return {}; }
  /// ln p(data | prediction, noise), every normaliser included. `noise`: the values of
  /// `parameters`. `predicted` holds frequencies where the problem's first observation is of
  /// numbered frequencies, modes where it is of modes. Standardised residuals may be appended to
  /// those of `out`; the rest of `out` is the first observation's.
  virtual double log_density(const Prediction& predicted, std::span<const double> noise,
                             inference::Evaluation& out) const = 0;
};

/// The lowest elastic frequencies, numbered: see NoiseModel.
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
