// Spectra, frequency responses, and changes of the sampling rate.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::signals {

/// Welch's method (1967): Hann windows over overlapping segments, mean of each segment removed.
struct WelchOptions {
  int segment = 1024;    ///< samples; at most the record
  double overlap = 0.5;  ///< fraction of a segment, in [0, 1)
};

/// One-sided power spectral density: ∫ density df is the variance.
struct Spectrum {
  std::vector<double> frequencies_hz;
  std::vector<double> density;  ///< [unit² / Hz]
  int segments = 0;
};

/// Throws std::invalid_argument for fewer than 4 samples, a rate <= 0 or an overlap outside [0, 1).
[[nodiscard]] Spectrum welch(std::span<const double> x, double sample_rate_hz,
                             WelchOptions options = {});

/// Frequency response of y to x. H1 = S_xy / S_xx is for noise on the output, H2 = S_yy / S_yx for
/// noise on the input. The coherence is γ² = |S_xy|² / (S_xx S_yy) = H1 / H2; with a single segment
/// it is always 1.
struct FrequencyResponse {
  std::vector<double> frequencies_hz;
  std::vector<std::complex<double>> h1, h2;
  std::vector<double> coherence;
  int segments = 0;
};

[[nodiscard]] FrequencyResponse frequency_response(std::span<const double> x,
                                                   std::span<const double> y, double sample_rate_hz,
                                                   WelchOptions options = {});

/// Compares samples [begin, end) with the whole record; both spectra use the same segments.
struct SpectrumComparison {
  Spectrum full, window;
  double power_ratio = 1.0;  ///< variance in the window over that in the record
  /// Root mean square of 10 log₁₀(window / full) over the frequencies with 99.9 % of the record's
  /// power, and its expectation for two independent estimates of the same spectrum.
  double difference_db = 0.0;
  double expected_db = 0.0;
};

/// Compares a window of a record with the whole record; segments are at most as long as the window.
/// Throws std::invalid_argument for an invalid window.
[[nodiscard]] SpectrumComparison compare_window(std::span<const double> record, int begin, int end,
                                                double sample_rate_hz, WelchOptions options = {});

/// The share of a signal's amplitude lost by linear interpolation between its samples: 1 - √(Σ S
/// sinc⁴(f / f_s) / Σ S) over its spectrum (a component at f keeps sinc²(f/f_s)).
[[nodiscard]] double linear_interpolation_loss(const Spectrum& spectrum, double sample_rate_hz);

/// Subtracts the least-squares polynomial of degree 0 (mean) or 1 (line), in place.
void detrend(std::span<double> x, int degree);

/// Interpolates samples [begin, end) of a record to `factor` times its rate: (end - begin - 1) ·
/// factor + 1 values, the original samples unchanged. Uses a sinc of 32 samples to either side with
/// a Kaiser window (β = 12), which keeps content below 0.43 of the sampling rate to 1e-5 of its
/// amplitude. It uses samples outside the window if the record contains them. Beyond its ends, the
/// record is continued by odd reflection, so the first and last 32 samples are less accurate.
/// Throws std::invalid_argument for a factor < 1 or an invalid window.
[[nodiscard]] std::vector<double> upsample(std::span<const double> record, int begin, int end,
                                           int factor);

/// Every `factor`-th sample from the first on, after a zero-phase low-pass: content below 0.4 of
/// the new rate is kept, and content above 0.5 of it, which would alias, is removed, both to 1e-4
/// of the amplitude. The record is continued beyond its ends by odd reflection. Throws
/// std::invalid_argument for a factor < 1.
[[nodiscard]] std::vector<double> decimate(std::span<const double> x, int factor);

/// A point of the plot of a spectrum.
struct SpectralLevel {
  double frequency_hz, level_db;
};

/// The level in dB of the sum of the channels' spectral densities, each divided by the channel's
/// variance, within [lowest_hz, highest_hz]. Lines with a sum of 0 are omitted. `records`: one
/// channel per row.
[[nodiscard]] std::vector<SpectralLevel> spectral_levels(
    const Eigen::Ref<const Eigen::MatrixXd>& records, double sample_rate_hz, double lowest_hz,
    double highest_hz);

/// Reduces a spectrum to at most `most` lines: the highest line of each group of neighbouring
/// lines.
[[nodiscard]] std::vector<SpectralLevel> highest_lines(const std::vector<SpectralLevel>& levels,
                                                       std::size_t most);

}  // namespace wheeltap::signals
