// Spectra, frequency response functions, and changes of the sampling rate.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::signals {

/// Options of Welch's method (1967): Hann windows over overlapping segments, after subtraction of
/// the mean of each segment.
struct WelchOptions {
  int segment = 1024;    ///< segment length in samples, at most the length of the record
  double overlap = 0.5;  ///< overlap as a fraction of the segment length, in [0, 1)
};

/// One-sided power spectral density of a signal: ∫ density df is the variance of the signal.
struct Spectrum {
  std::vector<double> frequencies_hz;
  std::vector<double> density;  ///< [unit² / Hz]
  int segments = 0;
};

/// Estimates the power spectral density of x by Welch's method. Throws std::invalid_argument for
/// fewer than 4 samples, a sampling rate <= 0 or an overlap outside [0, 1).
[[nodiscard]] Spectrum welch(std::span<const double> x, double sample_rate_hz,
                             WelchOptions options = {});

/// Frequency response function between the input x and the output y. H1 = S_xy / S_xx is the
/// estimate for noise in the output only, and H2 = S_yy / S_yx the estimate for noise in the input
/// only. The coherence is γ² = |S_xy|² / (S_xx S_yy) = H1 / H2. The coherence of a single segment
/// is always 1.
struct FrequencyResponse {
  std::vector<double> frequencies_hz;
  std::vector<std::complex<double>> h1, h2;
  std::vector<double> coherence;
  int segments = 0;
};

[[nodiscard]] FrequencyResponse frequency_response(std::span<const double> x,
                                                   std::span<const double> y, double sample_rate_hz,
                                                   WelchOptions options = {});

/// Comparison of a time window of a record with the whole record. Both spectra are estimated with
/// the same segment length.
struct SpectrumComparison {
  Spectrum full, window;
  double power_ratio = 1.0;  ///< variance of the window divided by the variance of the record
  /// `difference_db` is the root mean square of 10 log₁₀(window / full) over the frequencies that
  /// contain 99.9 % of the record's power. `expected_db` is the expected value of `difference_db`
  /// for two independent estimates of the same spectrum.
  double difference_db = 0.0;
  double expected_db = 0.0;
};

/// Compares samples [begin, end) of a record with the whole record. The segment length is at most
/// the length of this window. Throws std::invalid_argument for an invalid window.
[[nodiscard]] SpectrumComparison compare_window(std::span<const double> record, int begin, int end,
                                                double sample_rate_hz, WelchOptions options = {});

/// Linear interpolation between the samples decreases the RMS value of a signal. Returns the
/// relative decrease 1 - √(Σ S sinc⁴(f / f_s) / Σ S), summed over the spectrum S of the signal.
/// Linear interpolation multiplies the amplitude of a component of frequency f by sinc²(f / f_s).
[[nodiscard]] double linear_interpolation_loss(const Spectrum& spectrum, double sample_rate_hz);

/// Subtracts from x the least-squares polynomial of degree 0 (mean) or 1 (line), in place.
void detrend(std::span<double> x, int degree);

/// Interpolates samples [begin, end) of a record to `factor` times the sampling rate. The result
/// has (end - begin - 1) · factor + 1 values and contains the original samples unchanged. The
/// interpolation filter is a sinc function of 32 samples to either side with a Kaiser window (β =
/// 12). Signal components below 0.43 of the sampling rate keep their amplitude to a relative error
/// of 1e-5. The filter uses samples outside [begin, end) if the record contains them. Beyond its
/// ends, the record is continued by odd reflection, so the first and last 32 samples are less
/// accurate. Throws std::invalid_argument for a factor < 1 or an invalid window.
[[nodiscard]] std::vector<double> upsample(std::span<const double> record, int begin, int end,
                                           int factor);

/// Returns every `factor`-th sample of x, from the first sample on, after a zero-phase low-pass
/// filter. Below 0.4 times the new sampling rate, the relative change of the amplitudes is at most
/// 1e-4. Components above 0.5 times the new sampling rate would alias; the filter multiplies their
/// amplitude by 1e-4. The record is continued beyond its ends by odd reflection. Throws
/// std::invalid_argument for a factor < 1.
[[nodiscard]] std::vector<double> decimate(std::span<const double> x, int factor);

/// A point of a plotted spectrum.
struct SpectralLevel {
  double frequency_hz, level_db;
};

/// Computes the sum of the normalised spectral densities of all channels in dB, within [lowest_hz,
/// highest_hz]. The density of each channel is normalised by the variance of the channel. Spectral
/// lines at which the sum is 0 before the conversion to dB are omitted. `records` has one channel
/// per row.
[[nodiscard]] std::vector<SpectralLevel> spectral_levels(
    const Eigen::Ref<const Eigen::MatrixXd>& records, double sample_rate_hz, double lowest_hz,
    double highest_hz);

/// Reduces a spectrum to at most `most` spectral lines. Each group of neighbouring lines is
/// replaced by its highest line.
[[nodiscard]] std::vector<SpectralLevel> highest_lines(const std::vector<SpectralLevel>& levels,
                                                       std::size_t most);

}  // namespace wheeltap::signals
