// Frequency responses of several outputs to several inputs, measured or estimated from records.
#pragma once

#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::signals {

struct FrequencyResponses {
  Eigen::VectorXd frequencies_hz = {};   ///< ascending
  std::vector<Eigen::MatrixXcd> h = {};  ///< outputs × inputs, one per frequency
  /// Multiple coherence |γ|² of each output with all inputs, outputs × frequencies; empty if
  /// unknown.
  Eigen::MatrixXd coherence = {};
  int segments = 0;  ///< number of averages; 0 if unknown

  [[nodiscard]] Eigen::Index lines() const { return frequencies_hz.size(); }
  [[nodiscard]] Eigen::Index outputs() const { return h.empty() ? 0 : h.front().rows(); }
  [[nodiscard]] Eigen::Index inputs() const { return h.empty() ? 0 : h.front().cols(); }

  /// The frequency responses at the lines within [lowest, highest] [Hz].
  [[nodiscard]] FrequencyResponses band(double lowest_hz, double highest_hz) const;
};

/// H₁ = S_yx S_xx⁻¹ by Welch's method: Hann windows that overlap by half, the mean of each segment
/// removed (Bendat & Piersol 2010, section 7.4). Noise on the outputs averages out; noise on the
/// inputs makes H₁ too small; resonances narrower than 1/segment duration are smeared. `inputs`,
/// `outputs`: one channel per row. If `segment` is 0, it is the largest power of 2 that fits eight
/// times into the record, and at least 16 samples. Throws std::invalid_argument for lengths that
/// differ, fewer than 2 segments for each input, a rate <= 0, and inputs that are linearly
/// dependent.
[[nodiscard]] FrequencyResponses estimate_frequency_responses(
    const Eigen::Ref<const Eigen::MatrixXd>& inputs,
    const Eigen::Ref<const Eigen::MatrixXd>& outputs, double sample_rate_hz, int segment);

}  // namespace wheeltap::signals
