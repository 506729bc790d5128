// Frequency response functions between several inputs and several outputs: measured, or estimated
// from records.
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

  /// Returns the frequency response functions at the spectral lines within [lowest_hz, highest_hz].
  [[nodiscard]] FrequencyResponses band(double lowest_hz, double highest_hz) const;
};

/// Estimates H₁ = S_yx S_xx⁻¹ by Welch's method: Hann windows with an overlap of 50 %, after
/// subtraction of the mean of each segment (Bendat & Piersol 2010, section 7.4). Errors due to
/// output noise decrease with the number of averages. Noise in the inputs reduces the magnitude of
/// H₁. For resonances narrower than 1 / (segment duration), the estimated peaks are too wide and
/// too low. `inputs` and `outputs` have one channel per row. `segment` is the segment length in
/// samples. If `segment` is 0, the segment length is the largest power of 2 that fits eight times
/// into the record, and at least 16 samples. Throws std::invalid_argument for inputs and outputs of
/// different lengths, fewer than 2 segments per input, a sampling rate <= 0, and linearly dependent
/// inputs.
[[nodiscard]] FrequencyResponses estimate_frequency_responses(
    const Eigen::Ref<const Eigen::MatrixXd>& inputs,
    const Eigen::Ref<const Eigen::MatrixXd>& outputs, double sample_rate_hz, int segment);

}  // namespace wheeltap::signals
